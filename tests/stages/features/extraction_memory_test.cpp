// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/extraction_memory.h"

#include <gtest/gtest.h>

#include "tests/stages/features/photo_fixture.h"

namespace psfm {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20U;

/// What is asked for: two photographs of 24 megapixels at once within 1.5 GiB, with room to spare.
TEST(ExtractionMemoryTest, TwoOf24MegapixelsTakeLessThanHalfOfTheBudget) {
    const std::size_t bytes = extraction_bytes({6000, 4000}, 10 * kMiB, {});
    EXPECT_LT(2 * bytes, 768 * kMiB);
    EXPECT_GT(bytes, 3 * 24'000'000U);  // its colours alone
    EXPECT_LT(extraction_bytes({4000, 3000}, 5 * kMiB, {}), bytes);
}

TEST(ExtractionMemoryTest, GrowsWithTheSizeThatIsDetectedIn) {
    FeatureOptions larger;
    larger.sift.max_image_size = 6000;
    EXPECT_GT(extraction_bytes({6000, 4000}, 0, larger), extraction_bytes({6000, 4000}, 0, {}));
    larger.sift.strip_mib += 10;
    EXPECT_EQ(extraction_bytes({600, 400}, 0, larger),
              extraction_bytes({600, 400}, 0, {}) + 10 * kMiB);
}

TEST(ExtractionMemoryTest, ReadsTheSizeInTheHeader) {
    const testing::TemporaryFolder folder;
    const testing::Bytes bytes = testing::encode(testing::textured_image(640, 480), ".jpg");
    const PhotoFile photo = folder.write("a.jpg", bytes);
    EXPECT_EQ(extraction_bytes(photo, {}), extraction_bytes({640, 480}, bytes.size(), {}));
}

TEST(ExtractionMemoryTest, OfOtherFilesIsGuessedByTheirLength) {
    const testing::TemporaryFolder folder;
    const PhotoFile photo = folder.write("a.heic", testing::Bytes(1000, 7));
    EXPECT_GT(extraction_bytes(photo, {}), extraction_bytes({0, 0}, 1000, {}));
    EXPECT_EQ(extraction_bytes({folder.path() / "none.jpg", "none.jpg"}, {}), 0U);
    EXPECT_EQ(extraction_bytes({folder.path(), "folder"}, {}), 0U);
}

}  // namespace
}  // namespace psfm
