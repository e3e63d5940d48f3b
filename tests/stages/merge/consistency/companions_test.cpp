// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/merge/consistency/companions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "stages/merge/consistency/find_contradictions.h"
#include "tests/synthetic/rng.h"
#include "tests/synthetic/scene.h"

namespace psfm {
namespace {

/// Cameras of about a street, looking about one way, that see things at some depths.
struct Model {
    Reconstruction reconstruction;
    std::shared_ptr<ModelCameras> cameras;

    /// Looking along z, all seeing as far.
    Model(std::uint32_t first, const std::vector<Eigen::Vector3d>& centres, double depth) {
        for (std::uint32_t k = 0; k < centres.size(); ++k) {
            RegisteredImage& image = reconstruction.images.emplace_back();
            image.image = ImageId{first + k};
            image.cam_from_cluster.translation = -centres[k];
        }
        cameras = std::make_shared<ModelCameras>(*cameras_of(reconstruction));
        cameras->depths.assign(centres.size(), depth);
        cameras->largest_depth = depth;
    }

    Model(std::uint32_t first, std::uint32_t count, synthetic::Rng& rng, double spread = 1.0) {
        for (std::uint32_t k = 0; k < count; ++k) {
            RegisteredImage image;
            image.image = ImageId{first + k};
            const Eigen::Vector3d turn = 0.15 * rng.normal3();
            image.cam_from_cluster.rotation =
                Eigen::AngleAxisd(turn.norm(), turn.normalized()) * Eigen::Quaterniond::Identity();
            const Eigen::Vector3d centre =
                spread * rng.normal3().cwiseProduct(Eigen::Vector3d(4.0, 0.7, 0.2));
            image.cam_from_cluster.translation = -(image.cam_from_cluster.rotation * centre);
            reconstruction.images.push_back(image);
        }
        cameras = std::make_shared<ModelCameras>(*cameras_of(reconstruction));
        for (double& depth : cameras->depths) {
            depth = rng.uniform(3.0, 12.0);
            cameras->largest_depth = std::max(cameras->largest_depth, depth);
        }
    }
    LookedAtModel looked_at() const { return {&reconstruction, cameras.get()}; }
};

ClusterPairEdgesPtr some_edges(const Model& a, const Model& b, double part, synthetic::Rng& rng) {
    std::vector<VerifiedPairPtr> edges;
    std::vector<ImagePair> weak;
    for (const RegisteredImage& x : a.reconstruction.images) {
        for (const RegisteredImage& y : b.reconstruction.images) {
            if (x.image == y.image || rng.uniform(0.0, 1.0) > part) continue;
            VerifiedPair pair;
            pair.pair = ImagePair::of(x.image, y.image);
            if (rng.uniform() < 0.5) {
                weak.push_back(pair.pair);
            } else {
                edges.push_back(std::make_shared<const VerifiedPair>(pair));
            }
        }
    }
    return cluster_pair_edges(ClusterId{0}, ClusterId{1}, std::move(edges), std::move(weak));
}

/// Every camera of one model against every one of the other.
bool contradict(const Model& a, const Model& b, const Sim3& b_from_a,
                const std::vector<ImagePair>& matched, const ClusterConstraintOptions& options) {
    std::vector<int> standing_a(a.cameras->depths.size(), 0);  // 1: companions, 2: matched ones
    std::vector<int> standing_b(b.cameras->depths.size(), 0);
    for (std::size_t k = 0; k < standing_a.size(); ++k) {
        for (std::size_t o = 0; o < standing_b.size(); ++o) {
            const RegisteredImage& x = a.reconstruction.images[k];
            const RegisteredImage& y = b.reconstruction.images[o];
            const Eigen::Vector3d shift = b_from_a * x.cam_from_cluster.target_origin_in_source() -
                                          y.cam_from_cluster.target_origin_in_source();
            const double depth =
                std::min(b_from_a.scale * a.cameras->depths[k], b.cameras->depths[o]);
            const Eigen::Vector3d ahead_x =
                b_from_a.rotation *
                (x.cam_from_cluster.rotation.conjugate() * Eigen::Vector3d::UnitZ());
            const Eigen::Vector3d ahead_y =
                y.cam_from_cluster.rotation.conjugate() * Eigen::Vector3d::UnitZ();
            const double cosine = std::cos(options.companion_turn_deg * std::numbers::pi / 180.0);
            if (x.image == y.image || shift.norm() >= options.companion_offset * depth ||
                ahead_x.dot(ahead_y) < cosine)
                continue;
            const ImagePair pair = ImagePair::of(x.image, y.image);
            const int found = std::ranges::find(matched, pair) != matched.end() ? 2 : 1;
            for (int* standing : {&standing_a[k], &standing_b[o]})
                *standing = std::max(*standing, found);
        }
    }
    const auto with = [&](int value) {
        return static_cast<double>(std::ranges::count(standing_a, value) +
                                   std::ranges::count(standing_b, value));
    };
    return with(1) >= options.min_unmatched_cameras &&
           with(1) > options.max_unmatched_part * (with(1) + with(2));
}

Sim3 any_gauge(synthetic::Rng& rng, double turn, double shift) {
    Sim3 gauge;
    gauge.scale = std::exp(rng.uniform(-0.5, 0.5));
    const Eigen::Vector3d axis = rng.normal3();
    gauge.rotation = Eigen::AngleAxisd(turn * rng.uniform(0.0, 1.0), axis.normalized()) *
                     Eigen::Quaterniond::Identity();
    gauge.translation = shift * rng.normal3();
    return gauge;
}

/// Moved a little: in place, in scale and in direction, about some point.
Sim3 nudged(const Sim3& b_from_a, const Eigen::Vector3d& about, double by, synthetic::Rng& rng) {
    Sim3 nudge;
    nudge.scale = std::exp(0.05 * by * rng.uniform(-1.0, 1.0));
    nudge.rotation = rng.small_rotation(0.3 * by);
    nudge.translation = about - nudge * about;
    if (rng.uniform() < 0.5) nudge.translation += by * rng.normal3();
    return nudge * b_from_a;
}

TEST(Companions, AreThoseThatEveryPairOfCamerasTells) {
    synthetic::Rng rng(1);
    std::size_t contradictions = 0;
    constexpr std::size_t kTrials = 400;
    for (std::size_t trial = 0; trial < kTrials; ++trial) {
        // Some have an image in common.
        const Model a(0, 10 + static_cast<std::uint32_t>(trial % 13), rng);
        const Model b(8 + static_cast<std::uint32_t>(trial % 30), 14, rng);
        const Sim3 b_from_a = any_gauge(rng, 0.3, 2.0);
        const auto edges = some_edges(a, b, rng.uniform(0.0, 0.1), rng);
        const bool truth = contradict(a, b, b_from_a, edges->matched, {});
        EXPECT_EQ(
            judge_companions(a.looked_at(), b.looked_at(), b_from_a, edges->matched, {}).contradict,
            truth)
            << trial;
        contradictions += truth ? 1 : 0;
    }
    EXPECT_GT(contradictions, kTrials / 8);
    EXPECT_LT(contradictions, 7 * kTrials / 8);
}

TEST(Companions, AVerdictHoldsAsFarAsItSays) {
    synthetic::Rng rng(2);
    std::size_t held = 0;
    std::size_t changed = 0;
    std::size_t contradictions = 0;
    for (std::size_t trial = 0; trial < 1500; ++trial) {
        // Cameras about one place, which only turn away from each other; short and long streets.
        constexpr double kSpreads[] = {0.05, 1.0, 8.0};
        const double spread = kSpreads[trial % 3];
        const Model a(0, 12, rng, spread);
        const Model b(12, 8 + static_cast<std::uint32_t>(trial % 9), rng, spread);
        const Sim3 b_from_a = any_gauge(rng, spread > 1.0 ? 0.1 : 0.5, std::min(spread, 1.5));
        const auto edges = some_edges(a, b, rng.uniform(0.0, 0.1), rng);
        const auto verdict =
            judge_companions(a.looked_at(), b.looked_at(), b_from_a, edges->matched, {});
        for (const double by : {0.01, 0.03, 0.1, 0.3, 1.0}) {
            const Sim3 moved = nudged(b_from_a, b_from_a * a.cameras->middle, by, rng);
            const bool truth = contradict(a, b, moved, edges->matched, {});
            changed += truth != verdict.contradict ? 1 : 0;
            if (!still_holds(verdict, *a.cameras, b_from_a, moved, {})) continue;
            EXPECT_EQ(verdict.contradict, truth) << trial << " moved by " << by;
            ++held;
            contradictions += truth ? 1 : 0;
        }
    }
    EXPECT_GT(held, 500U);
    EXPECT_GT(contradictions, 200U);
    EXPECT_GT(changed, 120U) << "moves that matter";
}

TEST(Companions, AVerdictDoesNotHoldWhereTurningMovesFarCameras) {
    std::vector<Eigen::Vector3d> ends;
    std::vector<Eigen::Vector3d> beside;
    for (int k = 0; k < 6; ++k) {
        ends.insert(ends.end(), {{20.0 + 0.01 * k, 0.0, 0.0}, {-20.0 - 0.01 * k, 0.0, 0.0}});
        beside.emplace_back(20.0 + 0.01 * k, -1.0, 0.0);
    }
    const Model a(0, ends, 8.0);
    const Model b(20, beside, 8.0);
    const auto verdict = judge_companions(a.looked_at(), b.looked_at(), {}, {}, {});
    EXPECT_TRUE(verdict.contradict);
    EXPECT_GT(verdict.turn, 0.06);
    Sim3 moved;
    moved.translation.y() = 0.9 * verdict.shift;
    EXPECT_TRUE(still_holds(verdict, *a.cameras, {}, moved, {}));
    Sim3 turned;
    turned.rotation = Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitZ());
    EXPECT_FALSE(contradict(a, b, turned, {}, {})) << "the end is 2.2 m away";
    EXPECT_FALSE(still_holds(verdict, *a.cameras, {}, turned, {}));
}

/// Models along a street.
struct Street {
    std::vector<Model> models;
    std::vector<PlacedModel> placed;
    std::vector<LinkedModels> links;

    Street(std::uint32_t count, double spacing, synthetic::Rng& rng) {
        for (std::uint32_t m = 0; m < count; ++m)
            models.emplace_back(20 * m, 20, rng, rng.uniform(0.2, 1.0));
        for (std::uint32_t m = 0; m < count; ++m) {
            Sim3 gauge = any_gauge(rng, 0.3, 2.0);
            gauge.translation.x() += spacing * rng.uniform(0.0, count);
            placed.push_back({ClusterId{m}, &models[m].reconstruction, models[m].cameras, gauge});
            for (std::uint32_t o = m + 1; o < count; ++o) {
                if ((m + o) % 3 == 0) continue;  // no edge at all
                const auto edges = some_edges(models[m], models[o], rng.uniform(0.0, 0.1), rng);
                links.push_back({m, o, edges});
            }
        }
    }

    /// Every camera against every other.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> contradictions(
        const ClusterConstraintOptions& options) const {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
        for (std::uint32_t m = 0; m < models.size(); ++m) {
            for (std::uint32_t o = m + 1; o < models.size(); ++o) {
                const auto link = std::ranges::find_if(
                    links, [&](const LinkedModels& l) { return l.a == m && l.b == o; });
                const std::vector<ImagePair> none;
                const Sim3 o_from_m =
                    inverse(placed[o].component_from_cluster) * placed[m].component_from_cluster;
                if (contradict(models[m], models[o], o_from_m,
                               link == links.end() ? none : link->edges->matched, options))
                    found.emplace_back(m, o);
            }
        }
        return found;
    }
};

TEST(FindContradictions, LooksAtAllModelsThatMeet) {
    synthetic::Rng rng(4);
    const Street street(40, 5.0, rng);
    for (const std::uint32_t unmatched : {1U, 5U}) {
        ClusterConstraintOptions options;
        options.min_unmatched_cameras = unmatched;
        options.max_unmatched_part = unmatched == 1 ? 0.0 : options.max_unmatched_part;
        const Contradictions found = find_contradictions(street.placed, street.links, {}, options);
        EXPECT_EQ(found.pairs, street.contradictions(options));
        EXPECT_GT(found.pairs.size(), 10U);
        EXPECT_LT(found.judgements.size(), 40U * 39U / 4U) << "most are far apart";
    }
}

TEST(FindContradictions, IsTheSameWithWhatIsKnown) {
    synthetic::Rng rng(3);
    Street street(12, 6.0, rng);
    auto& [models, placed, links] = street;
    Contradictions known = find_contradictions(placed, links, {}, {});
    EXPECT_GE(known.pairs.size(), 3U);
    EXPECT_LT(known.pairs.size(), known.judgements.size());
    std::size_t reused = 0;
    for (std::size_t step = 0; step < 40; ++step) {
        for (PlacedModel& model : placed)
            model.component_from_cluster =
                nudged(model.component_from_cluster,
                       model.component_from_cluster * model.cameras->middle, 0.01, rng);
        if (step % 4 == 0) {  // another model
            const std::size_t m = step % models.size();
            models[m] = Model(20 * static_cast<std::uint32_t>(m), 20, rng);
            placed[m].model = &models[m].reconstruction;
            placed[m].cameras = models[m].cameras;
        }
        for (std::size_t l = step % 5; l < links.size(); l += 5) {  // other edges
            LinkedModels& link = links[l];
            link.edges = some_edges(models[link.a], models[link.b], rng.uniform(0.0, 0.1), rng);
        }
        const Contradictions anew = find_contradictions(placed, links, {}, {});
        Contradictions with = find_contradictions(placed, links, known.judgements, {});
        EXPECT_EQ(with.pairs, anew.pairs) << step;
        ASSERT_EQ(with.judgements.size(), anew.judgements.size());
        for (std::size_t j = 0; j < with.judgements.size(); ++j) {
            const Sim3& then = with.judgements[j].b_from_a;
            reused += then.translation != anew.judgements[j].b_from_a.translation ? 1 : 0;
        }
        known = std::move(with);
    }
    EXPECT_GT(reused, 300U);
}

}  // namespace
}  // namespace psfm
