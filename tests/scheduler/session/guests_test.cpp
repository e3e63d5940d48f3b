// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Images that a cluster tries though they are not its members.
#include <gtest/gtest.h>

#include "scheduler/session/cluster_table.h"
#include "tests/scheduler/session/made_up_clusters.h"

namespace psfm {
namespace {

using namespace test;

TEST(Guests, AGuestIsPlacedByItsHost) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2}));
    table.apply(members(1, {3}));
    Solve solve = solve_of(*table.take_dirty().front(), images({0, 1, 2}));
    table.finish(solve.problem, solve.solution);
    using Host = std::pair<ImageId, std::optional<ClusterId>>;
    EXPECT_EQ(table.set_hosts(std::vector<Host>{{image(3), cluster(0)}}), std::vector{cluster(0)});
    EXPECT_TRUE(table.set_hosts(std::vector<Host>{{image(3), cluster(0)}}).empty())
        << "nothing new";
    EXPECT_EQ(table.of(image(3)).id, cluster(0));
    EXPECT_EQ(table.images_of(table.entries().at(cluster(0))), images({0, 1, 2, 3}));
    EXPECT_TRUE(table.images_of(table.entries().at(cluster(1))).empty());
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U) << "the host tries its guest";
    EXPECT_EQ(material_of(*dirty.front()), Models{images({0, 1, 2})}) << "and keeps what it has";
    Solve with_guest = solve_of(*dirty.front(), images({0, 1, 2, 3}));
    EXPECT_NE(table.finish(with_guest.problem, with_guest.solution), nullptr);

    // The guest's own cluster grows up: the host is solved again without it, and not anew.
    table.apply(members(1, {3, 4, 5}));
    EXPECT_EQ(table.set_hosts(std::vector<Host>{{image(3), std::nullopt}}),
              std::vector{cluster(0)});
    EXPECT_EQ(table.of(image(3)).id, cluster(1));
    const auto both = table.take_dirty();
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(table.images_of(*both.front()), images({0, 1, 2}));
    table.leave_out_who_left(std::vector{cluster(0)});
    EXPECT_EQ(material_of(*both.front()), Models{images({0, 1, 2})});
    EXPECT_EQ(images_in(*both.front()->published.model), images({0, 1, 2}));
}

TEST(Guests, ASplitModelKeepsWhatBecomesItsGuest) {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2, 3, 4}));
    solve_dirty(table);
    ClusteringEdit split = members(0, {0, 1, 2});
    split.changed.push_back({cluster(1), images({3})});
    split.changed.push_back({cluster(2), images({4})});
    using Host = std::pair<ImageId, std::optional<ClusterId>>;
    table.apply(split, [&] { table.set_hosts(std::vector<Host>{{image(3), cluster(0)}}); });
    EXPECT_EQ(material_of(table.entries().at(cluster(0))), Models{images({0, 1, 2, 3})})
        << "as a resumed session would find it";
}

TEST(Guests, ARestoredModelKeepsItsGuestsAndLosesStrangers) {
    ClusterEntry host;
    host.id = cluster(0);
    host.membership.members = images({0, 1, 2});
    host.membership.topology = host.published.topology = 2;
    host.published.revision = 1;
    const auto model = solve_of(host, images({0, 1, 2, 3})).solution.model;
    host.published.model = model;
    host.material.models = {{host.id, host.published.revision, model}};
    ClusterEntry small;
    small.id = cluster(1);
    small.membership.members = images({3});
    ClusterEntry other = host;
    other.id = cluster(2);
    other.membership.members = images({4, 5, 6});
    other.published.model = solve_of(other, images({4, 5, 6, 7})).solution.model;
    other.material.models = {{other.id, other.published.revision, other.published.model}};
    ImageHosts hosts = hosts_of({host, small, other});
    hosts.set_host(image(3), cluster(0));
    ClusterTable table(kMuMin, {host, small, other}, hosts);
    for (const ClusterEntry& entry : {host, other}) table.restore_models(entry);
    EXPECT_EQ(table.entries().at(cluster(0)).published.model, model);
    EXPECT_EQ(material_of(table.entries().at(cluster(0))), Models{images({0, 1, 2, 3})});
    ASSERT_NE(table.entries().at(cluster(2)).published.model, nullptr);
    EXPECT_EQ(images_in(*table.entries().at(cluster(2)).published.model), images({4, 5, 6}))
        << "7 stands elsewhere";
    EXPECT_EQ(material_of(table.entries().at(cluster(2))), Models{images({4, 5, 6})});
}

/// Two solved clusters; image 2 belongs to the first, which cannot place it.
ClusterTable table_with_stray() {
    ClusterTable table(kMuMin);
    table.apply(members(0, {0, 1, 2, 3}));
    table.apply(members(1, {4, 5, 6}));
    for (const ClusterEntry* entry : table.take_dirty()) {
        std::vector<ImageId> placed = entry->membership.members;
        std::erase(placed, image(2));
        Solve solve = solve_of(*entry, placed);
        table.finish(solve.problem, solve.solution);
    }
    return table;
}

TEST(AdoptedImages, ArePlacedByTheirHostAndStay) {
    ClusterTable table = table_with_stray();
    EXPECT_FALSE(table.hosts().is_adopted(image(2)));
    table.adopt(image(2), cluster(1));
    EXPECT_TRUE(table.hosts().is_adopted(image(2)));
    EXPECT_TRUE(table.stays_adopted(image(2))) << "it is being tried";
    EXPECT_EQ(table.of(image(2)).id, cluster(1));
    EXPECT_EQ(table.hosts().adopted_by(cluster(1)), images({2}));
    const auto dirty = table.take_dirty();
    ASSERT_EQ(dirty.size(), 1U) << "nothing changed for its own cluster";
    EXPECT_EQ(dirty.front()->id, cluster(1));
    Solve solve = solve_of(*dirty.front(), images({2, 4, 5, 6}));
    table.finish(solve.problem, solve.solution);
    EXPECT_TRUE(table.stays_adopted(image(2)));
    EXPECT_FALSE(table.busy());
}

TEST(AdoptedImages, ThatTheHostCannotPlaceGoHomeWhenSomethingChanges) {
    ClusterTable table = table_with_stray();
    table.adopt(image(2), cluster(1));
    Solve solve = solve_of(*table.take_dirty().front(), images({4, 5, 6}));
    table.finish(solve.problem, solve.solution);
    EXPECT_FALSE(table.stays_adopted(image(2)));
    EXPECT_FALSE(table.busy()) << "no cluster is tried again for that alone";
    using Host = std::pair<ImageId, std::optional<ClusterId>>;
    EXPECT_EQ(table.set_hosts(std::vector<Host>{{image(2), std::nullopt}}),
              (std::vector{cluster(0), cluster(1)}))
        << "its own cluster tries it again";
    EXPECT_EQ(table.of(image(2)).id, cluster(0));
    EXPECT_FALSE(table.hosts().is_adopted(image(2)));
    EXPECT_TRUE(table.hosts().adopted_by(cluster(1)).empty());
}

TEST(AdoptedImages, LeaveWhenTheyMoveOrTheirHostIsGone) {
    ClusterTable moved = table_with_stray();
    moved.adopt(image(2), cluster(1));
    moved.apply(members(2, {2, 7, 8}));
    EXPECT_FALSE(moved.stays_adopted(image(2)));
    ClusterTable orphan = table_with_stray();
    orphan.adopt(image(2), cluster(1));
    ClusteringEdit edit = members(3, {4, 5, 6, 7});
    edit.removed = {cluster(1)};
    orphan.apply(edit);
    EXPECT_FALSE(orphan.stays_adopted(image(2)));
    using Host = std::pair<ImageId, std::optional<ClusterId>>;
    EXPECT_EQ(orphan.set_hosts(std::vector<Host>{{image(2), std::nullopt}}),
              std::vector{cluster(0)});
}

TEST(AdoptedImages, AreRestored) {
    const ClusterTable before = table_with_stray();
    std::vector<ClusterEntry> entries;
    for (const auto& [id, entry] : before.entries()) entries.push_back(entry);
    ImageHosts hosts = hosts_of(entries);
    hosts.set_host(image(2), cluster(0));
    hosts.adopt(image(2), cluster(1));
    ClusterTable table(kMuMin, entries, hosts);
    for (const auto& [id, entry] : before.entries()) table.restore_models(entry);
    EXPECT_TRUE(table.hosts().is_adopted(image(2)));
    EXPECT_EQ(table.images_of(table.entries().at(cluster(1))), images({2, 4, 5, 6}));
    EXPECT_EQ(table.images_of(table.entries().at(cluster(0))), images({0, 1, 3}));
    EXPECT_FALSE(table.busy());
}

}  // namespace
}  // namespace psfm
