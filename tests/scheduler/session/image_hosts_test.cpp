// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/image_hosts.h"

#include <gtest/gtest.h>

#include "tests/scheduler/session/made_up_clusters.h"

namespace psfm::test {
namespace {

std::vector<ImageId> guests_of(const ImageHosts& hosts, std::uint32_t id) {
    const auto guests = hosts.guests_of(cluster(id));
    return {guests.begin(), guests.end()};
}

/// Images 0 to 2 of cluster 0, 3 and 4 of cluster 1.
ImageHosts five_images() {
    ImageHosts hosts;
    for (std::uint32_t i = 0; i < 5; ++i) hosts.belongs_to(image(i), cluster(i < 3 ? 0 : 1));
    return hosts;
}

TEST(ImageHosts, AnImageIsPlacedByItsOwnClusterUnlessItIsAGuest) {
    ImageHosts hosts = five_images();
    EXPECT_EQ(hosts.image_count(), 5U);
    EXPECT_EQ(hosts.placing(image(4)), cluster(1));
    hosts.set_host(image(4), cluster(0));
    hosts.set_host(image(3), cluster(0));
    EXPECT_EQ(hosts.placing(image(4)), cluster(0));
    EXPECT_EQ(hosts.own(image(4)), cluster(1));
    EXPECT_EQ(guests_of(hosts, 0), images({3, 4}));
    hosts.set_host(image(4), cluster(2));
    EXPECT_EQ(guests_of(hosts, 0), images({3}));
    EXPECT_EQ(guests_of(hosts, 2), images({4}));
    hosts.set_host(image(4), std::nullopt);
    EXPECT_EQ(hosts.placing(image(4)), cluster(1));
    EXPECT_TRUE(guests_of(hosts, 2).empty());
}

TEST(ImageHosts, AGuestStaysOneWhenItsClusterChanges) {
    ImageHosts hosts = five_images();
    hosts.set_host(image(4), cluster(0));
    hosts.belongs_to(image(4), cluster(2));
    EXPECT_EQ(hosts.own(image(4)), cluster(2));
    EXPECT_EQ(hosts.placing(image(4)), cluster(0));
}

TEST(ImageHosts, AdoptedIsWhoWasGivenAHostByAMerge) {
    ImageHosts hosts = five_images();
    hosts.set_host(image(3), cluster(0));
    hosts.adopt(image(4), cluster(0));
    EXPECT_FALSE(hosts.is_adopted(image(3)));
    EXPECT_TRUE(hosts.is_adopted(image(4)));
    EXPECT_EQ(guests_of(hosts, 0), images({3, 4}));
    EXPECT_EQ(hosts.adopted_by(cluster(0)), images({4}));
    EXPECT_TRUE(hosts.is_at_home(image(4)));
    hosts.belongs_to(image(4), cluster(2));
    EXPECT_FALSE(hosts.is_at_home(image(4))) << "it moved";
    hosts.set_host(image(4), cluster(0));
    EXPECT_FALSE(hosts.is_adopted(image(4))) << "another host, or the same by its edges";
    EXPECT_FALSE(hosts.is_at_home(image(3))) << "it never was adopted";
}

}  // namespace
}  // namespace psfm::test
