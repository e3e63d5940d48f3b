// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/records/record_key.h"

#include <gtest/gtest.h>

#include <random>

namespace psfm {
namespace {

TEST(RecordKey, BytesAreOrderedLikeNumbers) {
    std::mt19937_64 rng(1);
    for (int i = 0; i < 2000; ++i) {
        // Few different bits, so that equal parts are met as well.
        const auto draw = [&] { return static_cast<std::uint32_t>(rng()) & 0x01010101U; };
        const SolutionKey a{static_cast<ClusterId>(draw()), draw()};
        const SolutionKey b{static_cast<ClusterId>(draw()), draw()};
        EXPECT_EQ(a < b, encode_key(a) < encode_key(b));
        const SceneKey c{draw(), draw()};
        const SceneKey d{draw(), draw()};
        EXPECT_EQ(c < d, encode_key(c) < encode_key(d));
        EXPECT_EQ(a.cluster < b.cluster, encode_key(a.cluster) < encode_key(b.cluster));
    }
}

TEST(RecordKey, DecodesWhatItEncodes) {
    const SolutionKey solution{ClusterId{3}, 0x01020304U};
    const SceneKey scene{5, 0x0102030405060708U};
    EXPECT_EQ(decode_image_key(encode_key(ImageId{0x01020304U})), ImageId{0x01020304U});
    EXPECT_EQ(decode_cluster_key(encode_key(ClusterId{9})), ClusterId{9});
    EXPECT_EQ(decode_solution_key(encode_key(solution)), solution);
    EXPECT_EQ(decode_scene_key(encode_key(scene)), scene);
    EXPECT_EQ(decode_camera_key(camera_key(CameraId{2})), CameraId{2});
    EXPECT_EQ(decode_rejected_key(rejected_key("a/b.jpg")), "a/b.jpg");
    EXPECT_EQ(decode_superseded_key(superseded_key(solution)), solution);
}

TEST(RecordKey, IsAsWrittenInTheFormat) {
    EXPECT_EQ(encode_key(ImageId{7}), std::string("\0\0\0\7", 4));
    EXPECT_EQ(encode_key(SceneKey{1, 2}), std::string("\0\0\0\1\0\0\0\0\0\0\0\2", 12));
    EXPECT_EQ(superseded_key({ClusterId{1}, 2}), std::string("g\0\0\0\1\0\0\0\2", 9));
}

TEST(RecordKey, RefusesOtherBytes) {
    for (const std::string& key : {std::string(), std::string("abc"), std::string("abcde")}) {
        EXPECT_FALSE(decode_image_key(key));
        EXPECT_FALSE(decode_solution_key(key));
        EXPECT_FALSE(decode_scene_key(key));
        EXPECT_FALSE(decode_superseded_key(key));
    }
    EXPECT_FALSE(decode_camera_key(rejected_key("abcd")));
    EXPECT_FALSE(decode_rejected_key(settings_key()));
}

TEST(RecordKey, IsDescribedForPeople) {
    EXPECT_EQ(describe_key(Family::kPairs, encode_key(ImageId{7})), "image 7");
    EXPECT_EQ(describe_key(Family::kPoints, encode_key(SolutionKey{ClusterId{3}, 2})),
              "cluster 3, revision 2");
    EXPECT_EQ(describe_key(Family::kScenes, encode_key(SceneKey{36, 40})), "version 40, 36 images");
    EXPECT_EQ(describe_key(Family::kMeta, rejected_key("a.jpg")), "rejected photograph 'a.jpg'");
    EXPECT_EQ(describe_key(Family::kImages, "\x01\xff"), "key 01ff");
}

}  // namespace
}  // namespace psfm
