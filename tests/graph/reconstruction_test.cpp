// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/reconstruction.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

Reconstruction with_images(std::initializer_list<std::uint32_t> ids) {
    Reconstruction reconstruction;
    for (const std::uint32_t id : ids) {
        reconstruction.images.push_back({static_cast<ImageId>(id), static_cast<CameraId>(id), {}});
    }
    return reconstruction;
}

TEST(Reconstruction, FindsRegisteredImagesOnly) {
    const Reconstruction reconstruction = with_images({2, 3, 5, 8, 13});
    for (std::uint32_t id = 0; id < 20; ++id) {
        const RegisteredImage* found = reconstruction.find(ImageId{id});
        const bool registered = id == 2 || id == 3 || id == 5 || id == 8 || id == 13;
        ASSERT_EQ(found != nullptr, registered) << id;
        if (found == nullptr) continue;
        EXPECT_EQ(found->camera, CameraId{id});
    }
}

TEST(Reconstruction, EmptyOneHasNoImages) {
    const Reconstruction reconstruction;
    EXPECT_TRUE(reconstruction.empty());
    EXPECT_EQ(reconstruction.find(ImageId{0}), nullptr);
    EXPECT_FALSE(with_images({4}).empty());
}

TEST(Observation, SortsByImageThenFeature) {
    EXPECT_LT((Observation{ImageId{1}, 9}), (Observation{ImageId{2}, 0}));
    EXPECT_LT((Observation{ImageId{2}, 0}), (Observation{ImageId{2}, 1}));
    EXPECT_EQ((Observation{ImageId{2}, 1}), (Observation{ImageId{2}, 1}));
}

}  // namespace
}  // namespace psfm
