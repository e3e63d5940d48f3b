// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/edges_between_clusters.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/scheduler/session/made_up_clusters.h"

namespace psfm {
namespace {

using test::cluster;
using test::image;

/// Clusters whose images come, move, leave and are other clusters' guests; and their edges.
class Session {
  public:
    Session() : table_(test::kMuMin) {}

    void add_image(ClusterId to) {
        const ImageId added = view_graph_.add_node();
        members_[to].push_back(added);
        ClusteringEdit edit;
        edit.changed.push_back({to, members_[to]});
        table_.apply(edit);
    }

    void connect(std::uint32_t a, std::uint32_t b, double weight = 50.0, std::size_t inliers = 50) {
        auto pair = std::make_shared<VerifiedPair>();
        pair->pair = ImagePair::of(image(a), image(b));
        pair->geometry.inliers.resize(inliers);
        view_graph_.add_edge(image(a), image(b), weight, std::move(pair));
        table_.edges_changed(std::vector{image(a), image(b)});
    }

    void disconnect(std::uint32_t a, std::uint32_t b) {
        view_graph_.remove_edge(image(a), image(b));
        table_.edges_changed(std::vector{image(a), image(b)});
    }

    void move(std::uint32_t moved, ClusterId from, ClusterId to) {
        std::erase(members_[from], image(moved));
        members_[to].push_back(image(moved));
        std::ranges::sort(members_[to]);
        ClusteringEdit edit;
        for (const ClusterId changed : {std::min(from, to), std::max(from, to)})
            edit.changed.push_back({changed, members_[changed]});
        edit.moved.push_back({from, to, {image(moved)}});
        table_.apply(edit);
    }

    void remove(ClusterId gone, ClusterId to) {
        ClusteringEdit edit;
        edit.moved.push_back({gone, to, members_[gone]});
        std::ranges::copy(members_[gone], std::back_inserter(members_[to]));
        std::ranges::sort(members_[to]);
        members_.erase(gone);
        edit.changed.push_back({to, members_[to]});
        edit.removed.push_back(gone);
        table_.apply(edit, [&] {
            const auto guests = table_.hosts().guests_of(gone);
            for (const ImageId guest : std::vector(guests.begin(), guests.end()))
                host(guest, std::nullopt);
        });
    }

    /// Makes an image another cluster's guest; or its own cluster's again.
    void host(ImageId guest, std::optional<ClusterId> host) {
        if (host && std::ranges::count(members_[*host], guest) > 0) host.reset();
        const std::pair<ImageId, std::optional<ClusterId>> changed{guest, host};
        table_.set_hosts(std::span(&changed, 1));
    }

    void solve() {
        for (const ClusterEntry* entry : table_.take_dirty()) {
            test::Solve solve = test::solve_of(*entry, table_.images_of(*entry));
            table_.finish(solve.problem, solve.solution);
        }
    }

    ClusterTable& table() { return table_; }
    const ClusterEntry& entry(std::uint32_t number) const {
        return table_.entries().at(cluster(number));
    }
    const ViewGraph& view_graph() const { return view_graph_; }
    const std::map<ClusterId, std::vector<ImageId>>& members() const { return members_; }
    std::vector<ClusterPairEdgesPtr> update() {
        return between_.update(table_, view_graph_, options_);
    }
    std::vector<ClusterPairEdgesPtr> anew() const {
        return EdgesBetweenClusters().update(table_, view_graph_, options_);
    }
    bool connected(std::uint32_t a, std::uint32_t b) const {
        return view_graph_.find(image(a), image(b)) != nullptr;
    }
    std::size_t size() const { return view_graph_.size(); }

  private:
    ClusterTable table_;
    ViewGraph view_graph_;
    std::map<ClusterId, std::vector<ImageId>> members_;
    EdgesBetweenClusters between_;
    ClusterConstraintOptions options_;
};

std::vector<ImagePair> pairs_of(const ClusterPairEdges& edges) {
    std::vector<ImagePair> pairs;
    for (const VerifiedPairPtr& edge : edges.edges) pairs.push_back(edge->pair);
    return pairs;
}

Session two_clusters() {
    Session session;
    for (std::uint32_t i = 0; i < 8; ++i) session.add_image(cluster(i / 4));
    session.connect(0, 4);
    session.connect(7, 1);
    session.connect(0, 1);
    return session;
}

TEST(EdgesBetweenClusters, AreThoseBetweenPlacedImagesOfDifferentClusters) {
    Session session = two_clusters();
    EXPECT_TRUE(session.update().empty()) << "nothing is placed yet";
    session.solve();
    const auto pairs = session.update();
    ASSERT_EQ(pairs.size(), 1U);
    EXPECT_EQ(pairs[0]->a, cluster(0));
    EXPECT_EQ(pairs[0]->b, cluster(1));
    EXPECT_EQ(pairs_of(*pairs[0]),
              (std::vector{ImagePair::of(image(0), image(4)), ImagePair::of(image(1), image(7))}));
}

TEST(EdgesBetweenClusters, WeakOnesMatchImagesAndTieNothing) {
    Session session = two_clusters();
    session.connect(2, 6, 0.0);
    for (std::uint32_t i = 8; i < 12; ++i) session.add_image(cluster(2));
    session.connect(5, 9, 0.0);
    session.solve();
    const auto pairs = session.update();
    ASSERT_EQ(pairs.size(), 2U);
    EXPECT_EQ(pairs[0]->edges.size(), 2U);
    EXPECT_EQ(pairs[0]->matched,
              (std::vector{ImagePair::of(image(0), image(4)), ImagePair::of(image(1), image(7)),
                           ImagePair::of(image(2), image(6))}));
    EXPECT_TRUE(pairs[1]->edges.empty());
    EXPECT_EQ(pairs[1]->matched, (std::vector{ImagePair::of(image(5), image(9))}));
}

TEST(EdgesBetweenClusters, WeakOnesMatchByTheirPartOfTheBest) {
    Session session;
    for (std::uint32_t i = 0; i < 8; ++i) session.add_image(cluster(i / 4));
    session.connect(0, 1, 500.0, 500);
    session.connect(4, 5, 300.0, 300);
    session.connect(0, 4, 0.0, 59);  // the better one of either image has 500 and 300
    session.connect(1, 5, 0.0, 60);
    session.solve();
    ASSERT_EQ(session.update().size(), 1U);
    EXPECT_EQ(session.update()[0]->matched, (std::vector{ImagePair::of(image(1), image(5))}));
    session.disconnect(1, 5);
    EXPECT_TRUE(session.update().empty()) << "clusters that look alike have nothing in common";
}

TEST(EdgesBetweenClusters, ABetterEdgeMakesAWeakOneNone) {
    Session session = two_clusters();
    session.connect(2, 6, 0.0, 30);
    session.solve();
    ASSERT_EQ(session.update().size(), 1U);
    EXPECT_EQ(session.update()[0]->matched.size(), 3U);
    session.connect(2, 3, 200.0, 200);
    EXPECT_EQ(session.update()[0]->matched.size(), 3U) << "image 6 shares no more with any other";
    session.connect(6, 7, 200.0, 200);
    EXPECT_EQ(session.update()[0]->matched.size(), 2U);
}

TEST(EdgesBetweenClusters, ClustersThatHaveNotChangedAreNotLookedAtAgain) {
    Session session = two_clusters();
    for (std::uint32_t i = 8; i < 12; ++i) session.add_image(cluster(2));
    session.connect(5, 9);
    session.solve();
    const auto before = session.update();
    ASSERT_EQ(before.size(), 2U);
    EXPECT_EQ(session.update(), before) << "the same objects";
    session.add_image(cluster(2));
    session.solve();
    const auto after = session.update();
    ASSERT_EQ(after.size(), 2U);
    EXPECT_EQ(after[0], before[0]);
    EXPECT_NE(after[1], before[1]);
    EXPECT_EQ(after[1]->hash, before[1]->hash) << "of the same pairs";
}

TEST(EdgesBetweenClusters, OfThoseKeptApartAreWhatWasVerified) {
    Session session = two_clusters();
    session.connect(4, 5, 300.0, 300);
    session.solve();
    session.disconnect(0, 4);
    EdgeSelection selection;
    selection.edges.resize(session.size());
    selection.weak.resize(session.size());
    const auto verified = [](std::uint32_t a, std::uint32_t b, std::size_t inliers) {
        auto pair = std::make_shared<VerifiedPair>();
        pair->pair = ImagePair::of(image(a), image(b));
        pair->geometry.inliers.resize(inliers);
        return EdgeSelection::Edge{image(b), 1.0, std::move(pair)};
    };
    selection.edges[0] = {verified(0, 1, 100), verified(0, 4, 80)};
    selection.weak[0] = {verified(0, 5, 9), verified(0, 6, 9)};  // 5 has a better edge, as has 0
    selection.weak[1] = {verified(1, 2, 40), verified(1, 5, 12)};
    const auto pairs = verified_between(selection, session.view_graph(), session.entry(0),
                                        session.entry(1), ClusterConstraintOptions{});
    EXPECT_EQ(pairs->a, cluster(0));
    EXPECT_EQ(pairs->b, cluster(1));
    EXPECT_EQ(pairs_of(*pairs), (std::vector{ImagePair::of(image(0), image(4))}));
    EXPECT_EQ(pairs->matched,
              (std::vector{ImagePair::of(image(0), image(4)), ImagePair::of(image(0), image(6)),
                           ImagePair::of(image(1), image(5))}));
}

TEST(EdgesBetweenClusters, AGuestIsItsHosts) {
    Session session = two_clusters();
    session.solve();
    session.table().adopt(image(4), cluster(0));
    EXPECT_EQ(session.update().size(), 1U);
    EXPECT_EQ(session.update()[0]->edges.size(), 1U) << "its host has not placed it yet";
    session.solve();
    EXPECT_EQ(pairs_of(*session.update()[0]), (std::vector{ImagePair::of(image(1), image(7))}));
}

TEST(EdgesBetweenClusters, AreWhatLookingAtAllClustersFinds) {
    std::mt19937 random(3);
    const auto below = [&](std::size_t n) { return static_cast<std::uint32_t>(random() % n); };
    Session session;
    std::uint32_t next_cluster = 6;
    for (std::uint32_t i = 0; i < 24; ++i) session.add_image(cluster(i % next_cluster));
    std::size_t seen = 0;
    for (int step = 0; step < 600; ++step) {
        const auto any_cluster = [&] {
            return std::next(session.members().begin(), below(session.members().size()))->first;
        };
        const std::uint32_t a = below(session.size());
        const std::uint32_t b = below(session.size());
        const ClusterId from = any_cluster();
        const ClusterId to = any_cluster();
        switch (below(7)) {
            case 0:
                session.add_image(below(8) == 0 ? cluster(next_cluster++) : to);
                break;
            case 1:
            case 2:
                if (a != b && !session.connected(a, b))
                    session.connect(a, b, below(3) == 0 ? 0.0 : 50.0, 5 + below(200));
                break;
            case 3:
                if (a != b && session.connected(a, b)) session.disconnect(a, b);
                break;
            case 4:
                if (from != to && session.members().at(from).size() > 1) {
                    const auto& own = session.members().at(from);
                    session.move(index_of(own[below(own.size())]), from, to);
                }
                break;
            case 5:
                session.host(image(a), to);
                break;
            default:
                if (from != to && below(6) == 0) session.remove(from, to);
        }
        if (below(2) == 0) session.solve();
        const auto known = session.update();
        const auto anew = session.anew();
        ASSERT_EQ(known.size(), anew.size()) << step;
        for (std::size_t k = 0; k < known.size(); ++k) {
            ASSERT_EQ(known[k]->a, anew[k]->a) << step;
            ASSERT_EQ(known[k]->b, anew[k]->b) << step;
            ASSERT_EQ(pairs_of(*known[k]), pairs_of(*anew[k])) << step;
            ASSERT_EQ(known[k]->hash, anew[k]->hash) << step;
            ASSERT_EQ(known[k]->matched, anew[k]->matched) << step;
            ASSERT_EQ(known[k]->matched_hash, anew[k]->matched_hash) << step;
            ++seen;
        }
    }
    EXPECT_GT(seen, 1000U);
}

}  // namespace
}  // namespace psfm
