// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What `--preset paper` does otherwise (docs/commands.md), seen from outside.
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "stages/reconstruction/solve/solve_cluster.h"
#include "storage/exchange/database/colmap_database.h"
#include "tests/scheduler/imported_session.h"
#include "tests/stages/reconstruction/problems.h"
#include "tests/stages/reconstruction/two_streets.h"
#include "tests/synthetic/disturb.h"
#include "tests/synthetic/scene.h"
#include "tests/synthetic/verified_pairs.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using synthetic::SyntheticScene;

SyntheticScene noisy(const synthetic::SceneOptions& options) {
    return synthetic::add_pixel_noise(synthetic::make_scene(options, 1), 0.3, 2);
}

/// Sessions of made-up matches, once with each preset.
class PaperSession : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("psfm_paper_" + std::to_string(getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    void write(const SyntheticScene& scene, const std::vector<VerifiedPairPtr>& pairs) const {
        const auto writer = ColmapDatabaseWriter::create(folder_ / "database.db");
        ASSERT_TRUE(writer.ok()) << writer.error().message;
        for (const auto& [id, camera] : scene.cameras)
            ASSERT_TRUE((*writer)->add_camera(id, camera).ok());
        for (std::uint32_t i = 0; i < scene.images.size(); ++i) {
            Image image;
            image.id = ImageId{i};
            image.camera = scene.images[i].camera;
            image.name = name_of_image(i);
            ASSERT_TRUE((*writer)->add_image(image, scene.images[i].keypoints, {}).ok());
        }
        for (const VerifiedPairPtr& pair : pairs) {
            ASSERT_TRUE((*writer)
                            ->add_pair(*pair, scene.camera_of(pair->pair.first),
                                       scene.camera_of(pair->pair.second))
                            .ok());
        }
        ASSERT_TRUE((*writer)->finish().ok());
    }

    test::ImportedSession run(const std::string& preset) const {
        SessionConfig config;
        config.preset = preset;
        auto session =
            test::import_database(folder_ / "database.db", folder_ / preset, std::move(config));
        EXPECT_TRUE(session.ok()) << session.error().message;
        return session.ok() ? *std::move(session) : test::ImportedSession{};
    }

    static std::string name_of_image(std::uint32_t image) { return std::to_string(100 + image); }

    fs::path folder_;
};

/// The pairs of an image with those matches only that `keep` says of each pair.
std::vector<VerifiedPairPtr> thinned(
    std::vector<VerifiedPairPtr> pairs, ImageId image,
    const std::function<void(ImageId other, std::vector<FeatureMatch>&)>& thin) {
    for (VerifiedPairPtr& pair : pairs) {
        if (pair->pair.first != image && pair->pair.second != image) continue;
        VerifiedPair changed = *pair;
        thin(pair->pair.first == image ? pair->pair.second : pair->pair.first,
             changed.geometry.inliers);
        pair = std::make_shared<const VerifiedPair>(std::move(changed));
    }
    std::erase_if(pairs,
                  [](const VerifiedPairPtr& pair) { return pair->geometry.inliers.empty(); });
    return pairs;
}

synthetic::SceneOptions arc(std::uint32_t images, double degrees) {
    synthetic::SceneOptions options = synthetic::ring_around_sphere(images);
    options.cameras.arc_deg = degrees;
    return options;
}

// With the printed formula five images that all overlap are five clusters (JaccardForm::kLiteral).
TEST_F(PaperSession, FiveImagesAreNoClusterYet) {
    const SyntheticScene scene = noisy(arc(5, 15.0));
    const auto pairs = synthetic::make_verified_pairs(scene);
    ASSERT_EQ(pairs.size(), 10U) << "each with each";
    write(scene, pairs);
    EXPECT_EQ(run("default").run.counts.placed, 5U);
    const SessionRun paper = run("paper").run;
    EXPECT_EQ(paper.counts.placed, 0U);
    ASSERT_EQ(paper.waiting.size(), 5U);
    for (const auto& [name, reason] : paper.waiting)
        EXPECT_EQ(reason, WaitReason::kClusterTooSmall) << name;
}

TEST_F(PaperSession, AnImageOfWeakEdgesIsLeftOut) {
    const SyntheticScene scene = noisy(arc(16, 60.0));
    write(scene, thinned(synthetic::make_verified_pairs(scene), ImageId{15},
                         [](ImageId /*other*/, std::vector<FeatureMatch>& matches) {
                             matches.resize(std::min<std::size_t>(matches.size(), 25));
                         }));
    EXPECT_EQ(run("default").run.counts.placed, 16U);
    const SessionRun paper = run("paper").run;
    EXPECT_EQ(paper.counts.placed, 15U);
    ASSERT_EQ(paper.waiting.size(), 1U);
    EXPECT_EQ(paper.waiting.front().first, name_of_image(15));
}

/// The solve of a problem with each preset.
ClusterSolution solved(const ClusterProblem& problem, const std::string& preset) {
    SessionConfig config;
    config.preset = preset;
    const auto options = stage_options(config);
    EXPECT_TRUE(options.ok());
    auto solution = solve_cluster(problem, options->solve);
    EXPECT_TRUE(solution.ok()) << solution.error().message;
    return solution.ok() ? *std::move(solution) : ClusterSolution{};
}

/// A model that solving may begin from. REQUIRES: the problem is all of the scene
void begin_from(Reconstruction model, ClusterProblem& problem) {
    const auto images = static_cast<std::uint32_t>(problem.images.size());
    problem.recycled = {std::make_shared<const Reconstruction>(std::move(model))};
    problem.recycled_state = {.images_at_full_adjustment = images, .images_at_start = images};
}

TEST(PaperSolve, OneImageThatContradictsResetsTheWholeCluster) {
    const SyntheticScene scene = noisy(synthetic::ring_around_sphere(16));
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    problem.fix_intrinsics = true;
    Reconstruction model = synthetic::true_reconstruction(scene);
    Rigid3& pose = model.images[5].cam_from_cluster;
    pose.rotation = pose.rotation * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ());
    begin_from(model, problem);
    const ClusterSolution usual = solved(problem, "default");
    ASSERT_TRUE(usual.statistics.reset.has_value());
    EXPECT_EQ(usual.statistics.reset->images, std::vector{ImageId{5}});
    const ClusterSolution paper = solved(problem, "paper");
    ASSERT_TRUE(paper.statistics.reset.has_value());
    EXPECT_TRUE(paper.statistics.reset->images.empty()) << "all of them";
    EXPECT_EQ(paper.statistics.kind, SolveKind::kNew);
    EXPECT_EQ(paper.model->images.size(), 16U);
}

TEST(PaperSolve, PlacesThatStandSideBySideStayTogether) {
    const SyntheticScene scene = two_streets(30, 0.4, 7);
    ClusterProblem problem = problem_of(scene, synthetic::make_verified_pairs(scene));
    problem.fix_intrinsics = true;
    begin_from(synthetic::true_reconstruction(scene), problem);
    problem.settle = true;
    EXPECT_EQ(solved(problem, "default").places.size(), 2U);
    EXPECT_TRUE(solved(problem, "paper").places.empty());
}

TEST(PaperSolve, NoPrincipalPointIsAdjusted) {
    const SyntheticScene scene = noisy(synthetic::ring_around_sphere(12));
    auto cameras = scene.cameras;
    Camera& camera = cameras.begin()->second;
    camera.params[1] += 4.0;
    camera.focal_source = FocalSource::kExif;
    const Eigen::Vector2d given = camera.principal_point();
    const Eigen::Vector2d truth = scene.cameras.begin()->second.principal_point();
    ClusterProblem problem =
        problem_of(scene, synthetic::make_verified_pairs(scene), cameras, scene.images.size());
    Reconstruction model = synthetic::true_reconstruction(scene);
    model.cameras = cameras;
    begin_from(model, problem);
    problem.settle = true;
    const auto found = [&](const std::string& preset) {
        return solved(problem, preset).model->cameras.begin()->second.principal_point();
    };
    EXPECT_LT((found("default") - truth).norm(), 2.0);
    EXPECT_EQ(found("paper"), given);
}

// What it sees of the model are few points; only its edge to the last but one is strong.
TEST(PaperSolve, AnImageThatSeesFewPointsWaits) {
    constexpr ImageId kLast{11};
    const SyntheticScene scene = noisy(synthetic::ring_around_sphere(12));
    const auto all = synthetic::make_verified_pairs(scene);
    std::set<std::uint32_t> seen;  // features of the last but one that are points of the model
    std::vector<VerifiedPairPtr> pairs =
        thinned(all, kLast, [&](ImageId other, std::vector<FeatureMatch>& matches) {
            if (other != ImageId{10}) matches.clear();
            for (const FeatureMatch& match : matches) {
                if (seen.size() < 14) seen.insert(match.first);
            }
        });
    std::set<std::uint32_t> shared = seen;
    pairs = thinned(pairs, ImageId{10}, [&](ImageId other, std::vector<FeatureMatch>& matches) {
        const bool is_last = other == kLast;
        std::erase_if(matches, [&](const FeatureMatch& match) {
            const std::uint32_t feature = other < ImageId{10} ? match.second : match.first;
            if (is_last) return shared.contains(feature) && !seen.contains(feature);
            if (shared.size() < 60) shared.insert(feature);
            return !shared.contains(feature);
        });
    });
    ClusterProblem problem = problem_of(scene, pairs);
    problem.fix_intrinsics = true;
    EXPECT_EQ(solved(problem, "default").model->images.size(), 12U);
    const ClusterSolution paper = solved(problem, "paper");
    EXPECT_EQ(paper.model->images.size(), 11U);
    ASSERT_EQ(paper.waiting.size(), 1U);
    EXPECT_EQ(paper.waiting.front(), std::pair(kLast, WaitReason::kRegistrationFailed));
}

}  // namespace
}  // namespace psfm
