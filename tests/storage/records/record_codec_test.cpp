// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "storage/records/cluster_records.h"
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"
#include "storage/records/record_envelope.h"
#include "storage/records/scene_records.h"
#include "storage/records/solution_records.h"
#include "tests/storage/random_values.h"
#include "tests/synthetic/change_points.h"

namespace psfm {
namespace {

using testing::Rng;
using testing::same;

/// A payload of every kind, with a way to decode it.
struct Sample {
    std::string name;
    std::string payload;
    std::function<Result<void>(std::string_view)> decode;
};

template <typename Decode>
std::function<Result<void>(std::string_view)> ignoring_value(Decode decode) {
    return [decode](std::string_view payload) -> Result<void> {
        const auto decoded = decode(payload);
        if (!decoded) return decoded.error();
        return {};
    };
}

SceneRecord random_scene(Rng& rng) {
    SceneRecord record;
    record.scene.version = 12;
    record.scene.image_count = 1U << 31U;
    record.scene.effective_clusters = 2;
    record.scene.summary_json = testing::random_text(rng);
    for (std::uint32_t id = 1; id < 9; id += 1 + static_cast<std::uint32_t>(rng() % 3)) {
        record.scene.placements.push_back({static_cast<ClusterId>(id), id * 3,
                                           testing::random_members(rng() % 20, rng),
                                           testing::random_similarity(rng), id % 2});
        record.points_kept.push_back(rng() % 2 == 0);
    }
    return record;
}

std::vector<Sample> samples() {
    Rng rng(5);
    const auto images = testing::first_images(6);
    const Reconstruction model = testing::random_model(images, 12, rng);
    const std::vector<VerifiedPairPtr> pairs{testing::random_pair(ImageId{1}, ImageId{9}, 20, rng),
                                             testing::random_pair(ImageId{4}, ImageId{9}, 20, rng)};
    return {
        {"settings", *encode_settings({"/photos", "{\"seed\":1}"}),
         ignoring_value(decode_settings)},
        {"camera", *encode_camera(testing::random_camera(rng)), ignoring_value(decode_camera)},
        {"rejected", *encode_rejected({"a.jpg", "is empty", 1, 2}),
         ignoring_value([](std::string_view p) { return decode_rejected("a.jpg", p); })},
        {"image", *encode_image(testing::random_image(ImageId{3}, rng)),
         ignoring_value([](std::string_view p) { return decode_image(ImageId{3}, p); })},
        {"keypoints", *encode_keypoints(testing::random_keypoints(3, rng)),
         ignoring_value(decode_keypoints)},
        {"descriptors", *encode_descriptors(testing::random_descriptors(2, rng)),
         ignoring_value(decode_descriptors)},
        {"pairs", *encode_pairs(ImageId{9}, pairs),
         ignoring_value([](std::string_view p) { return decode_pairs(ImageId{9}, p); })},
        {"cluster",
         *encode_cluster(
             {{ClusterId{3}, images, 4, 2, 1, 4, {{ClusterId{2}, 7}}, {ImageId{900'000}}}, false}),
         ignoring_value([](std::string_view p) { return decode_cluster(ClusterId{3}, p); })},
        {"poses", *encode_poses(model), ignoring_value(decode_poses)},
        {"points", *encode_points(model, "{}"), ignoring_value(decode_points)},
        {"scene", *encode_scene(random_scene(rng)), ignoring_value([](std::string_view p) {
             return decode_scene({1U << 31U, 12}, p);
         })},
    };
}

TEST(RecordCodec, ImagesCamerasAndSettingsComeBackAlike) {
    Rng rng(1);
    for (int i = 0; i < 200; ++i) {
        Image image = testing::random_image(ImageId{17}, rng);
        image.metadata.digital_zoom = 1.0 + 0.25 * (i % 8);
        image.metadata.focal_is_vague = i % 2 == 1;
        const auto decoded = decode_image(ImageId{17}, *encode_image(image));
        ASSERT_TRUE(decoded.ok());
        EXPECT_TRUE(same(*decoded, image));

        const Camera camera = testing::random_camera(rng);
        EXPECT_EQ(*decode_camera(*encode_camera(camera)), camera);

        const SessionSettings settings{testing::random_text(rng), testing::random_text(rng)};
        const auto decoded_settings = decode_settings(*encode_settings(settings));
        EXPECT_EQ(decoded_settings->photo_folder, settings.photo_folder);
        EXPECT_EQ(decoded_settings->settings_json, settings.settings_json);

        const RejectedPhoto photo{testing::random_text(rng), testing::random_text(rng), rng(),
                                  static_cast<std::int64_t>(rng())};
        const auto decoded_photo = decode_rejected(photo.name, *encode_rejected(photo));
        EXPECT_EQ(decoded_photo->reason, photo.reason);
        EXPECT_EQ(decoded_photo->content_hash, photo.content_hash);
        EXPECT_EQ(decoded_photo->file_size, photo.file_size);
    }
}

TEST(RecordCodec, FeaturesComeBackAlike) {
    Rng rng(2);
    for (const std::size_t count : {0U, 1U, 1000U}) {
        const Keypoints keypoints = testing::random_keypoints(count, rng);
        EXPECT_EQ(*decode_keypoints(*encode_keypoints(keypoints)), keypoints);
        const Descriptors descriptors = testing::random_descriptors(count, rng);
        EXPECT_EQ(*decode_descriptors(*encode_descriptors(descriptors)), descriptors);
    }
}

TEST(RecordCodec, PairsComeBackAlike) {
    Rng rng(3);
    for (std::uint32_t count = 0; count < 30; ++count) {
        std::vector<VerifiedPairPtr> pairs;
        for (std::uint32_t other = 0; other < count; ++other) {
            VerifiedPair pair = *testing::random_pair(static_cast<ImageId>(3 * other), ImageId{90},
                                                      10 * count, rng);
            if (other % 2 == 1) pair.geometry.still = pair.geometry.inliers;
            pairs.push_back(std::make_shared<const VerifiedPair>(std::move(pair)));
        }
        const auto decoded = decode_pairs(ImageId{90}, *encode_pairs(ImageId{90}, pairs));
        ASSERT_TRUE(decoded.ok());
        ASSERT_EQ(decoded->size(), pairs.size());
        for (std::uint32_t i = 0; i < count; ++i) EXPECT_TRUE(same(*(*decoded)[i], *pairs[i]));
    }
}

TEST(RecordCodec, ClustersComeBackAlike) {
    Rng rng(4);
    for (std::uint32_t count = 1; count < 50; ++count) {
        StoredCluster cluster{ClusterId{3},
                              testing::random_members(count, rng),
                              count + 4,
                              count,
                              2 * count,
                              count % 3,
                              std::vector<SolutionReference>(count, {ClusterId{count}, 5}),
                              {}};
        for (std::uint32_t adopted = 0; adopted < count % 4; ++adopted)
            cluster.adopted.push_back(
                ImageId{index_of(cluster.members.back()) + 1 + 300 * adopted});
        for (std::uint32_t pair = 0; pair < count % 5; ++pair)
            cluster.apart.push_back({cluster.members[count / 2],
                                     ImageId{index_of(cluster.members[count / 2]) + 1 + 9 * pair}});
        const auto decoded =
            decode_cluster(ClusterId{3}, *encode_cluster({cluster, count % 2 == 0}));
        ASSERT_TRUE(decoded.ok());
        EXPECT_TRUE(same(decoded->cluster, cluster));
        EXPECT_EQ(decoded->removed, count % 2 == 0);
    }
}

TEST(RecordCodec, PairsOfDifferentPlacesAreOrderedAndOfMembers) {
    StoredCluster cluster;
    cluster.members = {ImageId{2}, ImageId{5}};
    const auto storable = [&](std::vector<ImagePair> apart) {
        cluster.apart = std::move(apart);
        return encode_cluster({cluster, false}).ok();
    };
    EXPECT_TRUE(storable({{ImageId{2}, ImageId{5}}, {ImageId{5}, ImageId{9}}}));
    EXPECT_FALSE(storable({{ImageId{5}, ImageId{9}}, {ImageId{2}, ImageId{5}}}));
    EXPECT_FALSE(storable({{ImageId{5}, ImageId{9}}, {ImageId{5}, ImageId{9}}}));
    EXPECT_FALSE(storable({{ImageId{5}, ImageId{2}}}));
    EXPECT_FALSE(storable({{ImageId{3}, ImageId{5}}})) << "image 3 is another cluster's";
}

TEST(RecordCodec, SolutionsComeBackAlike) {
    Rng rng(5);
    for (std::uint32_t count = 0; count < 40; ++count) {
        const Reconstruction model =
            testing::random_model(testing::random_members(count, rng), 5 * count, rng);
        const auto poses = decode_poses(*encode_poses(model));
        ASSERT_TRUE(poses.ok());
        EXPECT_TRUE(testing::same_poses(poses->model, model));
        EXPECT_TRUE(poses->model.points.empty());
        const std::string state = testing::random_text(rng);
        auto points = decode_points(*encode_points(model, state));
        ASSERT_TRUE(points.ok());
        EXPECT_EQ(points->state_json, state);
        Reconstruction with_points = poses->model;
        with_points.points = std::move(points->points);
        EXPECT_TRUE(testing::same_points(with_points, model));
    }
}

TEST(RecordCodec, PointsOfLargeModelsComeBackAlike) {
    // Enough for several tasks, the last one not full; each part starts its tracks anew.
    Rng rng(6);
    const Reconstruction model = testing::random_model(testing::first_images(3), 20'001, rng);
    const auto points = decode_points(*encode_points(model, "{}"));
    ASSERT_TRUE(points.ok());
    Reconstruction decoded = model;
    decoded.points = points->points;
    EXPECT_TRUE(testing::same_points(decoded, model));
    for (const std::size_t wrong : {std::size_t{0}, std::size_t{8191}, std::size_t{20'000}}) {
        Reconstruction broken = model;
        synthetic::change_points(broken, [&](std::vector<ScenePoint>& changed) {
            changed[wrong].error_px = std::numeric_limits<float>::quiet_NaN();
        });
        const auto refused = encode_points(broken, "{}");
        ASSERT_FALSE(refused.ok());
        EXPECT_NE(refused.error().message.find("point " + std::to_string(wrong) + " "),
                  std::string::npos)
            << refused.error().message;
    }
}

TEST(RecordCodec, ScenesComeBackAlike) {
    Rng rng(6);
    for (int i = 0; i < 50; ++i) {
        const SceneRecord record = random_scene(rng);
        const auto decoded = decode_scene({1U << 31U, 12}, *encode_scene(record));
        ASSERT_TRUE(decoded.ok());
        EXPECT_EQ(decoded->points_kept, record.points_kept);
        EXPECT_EQ(decoded->scene.version, record.scene.version);
        EXPECT_EQ(decoded->scene.image_count, record.scene.image_count);
        EXPECT_EQ(decoded->scene.effective_clusters, record.scene.effective_clusters);
        EXPECT_EQ(decoded->scene.summary_json, record.scene.summary_json);
        ASSERT_EQ(decoded->scene.placements.size(), record.scene.placements.size());
        for (std::size_t k = 0; k < record.scene.placements.size(); ++k) {
            const StoredPlacement& a = decoded->scene.placements[k];
            const StoredPlacement& b = record.scene.placements[k];
            EXPECT_EQ(a.cluster, b.cluster);
            EXPECT_EQ(a.revision, b.revision);
            EXPECT_EQ(a.members, b.members);
            EXPECT_TRUE(same(a.world_from_cluster, b.world_from_cluster));
            EXPECT_EQ(a.effective_cluster, b.effective_cluster);
        }
    }
}

TEST(RecordCodec, EveryFlippedByteOfASealedRecordIsDamage) {
    for (const Sample& sample : samples()) {
        const std::string value = seal_record(RecordKind::kScene, "key", sample.payload);
        for (std::size_t i = 0; i < value.size(); ++i) {
            for (const int mask : {0x01, 0x80, 0xff}) {
                std::string changed = value;
                changed[i] = static_cast<char>(changed[i] ^ mask);
                const auto opened = open_record(RecordKind::kScene, "key", changed);
                ASSERT_FALSE(opened.ok()) << sample.name << ", byte " << i;
                ASSERT_EQ(opened.error().code, ErrorCode::kDamaged);
            }
        }
    }
}

/// Behind the checksum: bytes that were never a payload must not crash a decoder either.
TEST(RecordCodec, NoPayloadCrashesADecoder) {
    Rng rng(8);
    for (const Sample& sample : samples()) {
        ASSERT_TRUE(sample.decode(sample.payload).ok()) << sample.name;
        for (std::size_t i = 0; i < sample.payload.size(); ++i) {
            for (const int mask : {0x01, 0x10, 0x80, 0xff}) {
                std::string changed = sample.payload;
                changed[i] = static_cast<char>(changed[i] ^ mask);
                const auto decoded = sample.decode(changed);
                if (!decoded) {
                    EXPECT_EQ(decoded.error().code, ErrorCode::kDamaged) << sample.name;
                }
            }
            static_cast<void>(sample.decode(sample.payload.substr(0, i)));
        }
        for (int round = 0; round < 300; ++round) {
            std::string noise(rng() % 200, ' ');
            for (char& byte : noise) byte = static_cast<char>(rng());
            static_cast<void>(sample.decode(noise));
        }
    }
}

TEST(RecordCodec, PayloadsMayLieAtAnyAddress) {
    for (const Sample& sample : samples()) {
        for (std::size_t shift = 0; shift < 9; ++shift) {
            const std::string moved = std::string(shift, ' ') + sample.payload;
            EXPECT_TRUE(sample.decode(std::string_view(moved).substr(shift)).ok()) << sample.name;
        }
    }
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(RecordCodec, RefusesImpossibleImages) {
    Rng rng(9);
    const auto broken = [&](const std::function<void(Image&)>& change) {
        Image image = testing::random_image(ImageId{1}, rng);
        change(image);
        return !encode_image(image).ok();
    };
    EXPECT_TRUE(broken([](Image& image) { image.name.clear(); }));
    EXPECT_TRUE(broken([](Image& image) { image.metadata.width = 0; }));
    EXPECT_TRUE(broken([](Image& image) { image.metadata.orientation = 9; }));
    EXPECT_TRUE(broken([](Image& image) { image.metadata.focal_px = kNaN; }));
    EXPECT_TRUE(broken([](Image& image) { image.metadata.gps = GpsPosition{kNaN, 0, {}}; }));
    Camera camera = testing::random_camera(rng);
    camera.params[2] = kNaN;
    EXPECT_FALSE(encode_camera(camera).ok());
    Keypoints keypoints = testing::random_keypoints(3, rng);
    keypoints[1].x = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(encode_keypoints(keypoints).ok());
    EXPECT_FALSE(encode_descriptors({std::vector<std::uint8_t>(127)}).ok());
}

TEST(RecordCodec, RefusesImpossiblePairs) {
    Rng rng(10);
    const auto good = testing::random_pair(ImageId{1}, ImageId{2}, 20, rng);
    const auto broken = [&](const std::function<void(VerifiedPair&)>& change) {
        auto pair = std::make_shared<VerifiedPair>(*good);
        pair->geometry.inliers = {{1, 5}, {2, 6}};
        change(*pair);
        return !encode_pairs(ImageId{2}, {pair}).ok();
    };
    EXPECT_FALSE(broken([](VerifiedPair&) {}));
    EXPECT_TRUE(broken([](VerifiedPair& pair) { pair.pair.second = ImageId{3}; }));
    EXPECT_TRUE(broken([](VerifiedPair& pair) { pair.geometry.inliers[1].first = 1; }));
    EXPECT_TRUE(broken([](VerifiedPair& pair) { pair.geometry.inliers[1].second = 5; }));
    EXPECT_TRUE(broken([](VerifiedPair& pair) { pair.geometry.matrix(0, 0) = kNaN; }));
    EXPECT_TRUE(
        broken([](VerifiedPair& pair) { pair.geometry.cam2_from_cam1.rotation.coeffs() *= 2.0; }));
    EXPECT_FALSE(encode_pairs(ImageId{2}, {good, good}).ok());
    EXPECT_FALSE(encode_pairs(ImageId{2}, {nullptr}).ok());
}

TEST(RecordCodec, RefusesImpossibleSolutionsClustersAndScenes) {
    Rng rng(11);
    const Reconstruction good = testing::random_model(testing::first_images(4), 10, rng);
    const auto broken = [&](const std::function<void(Reconstruction&)>& change) {
        Reconstruction model = good;
        change(model);
        return !encode_poses(model).ok() || !encode_points(model, "").ok();
    };
    EXPECT_FALSE(broken([](Reconstruction&) {}));
    EXPECT_TRUE(broken([](Reconstruction& m) { std::swap(m.images[0], m.images[1]); }));
    EXPECT_TRUE(broken([](Reconstruction& m) { m.cameras.erase(m.images[0].camera); }));
    EXPECT_TRUE(
        broken([](Reconstruction& m) { m.images[0].cam_from_cluster.translation.x() = kNaN; }));
    const auto broken_points = [&](const std::function<void(std::vector<ScenePoint>&)>& change) {
        return broken([&](Reconstruction& m) { synthetic::change_points(m, change); });
    };
    EXPECT_FALSE(broken_points([](auto&) {}));
    EXPECT_TRUE(broken_points([](auto& points) { points[0].track.resize(1); }));
    EXPECT_TRUE(broken_points([](auto& points) { points[0].position.z() = kNaN; }));
    EXPECT_TRUE(broken_points([](auto& points) { points[0].track = points[1].track; }));
    EXPECT_TRUE(broken_points([](auto& points) { points[0].track.back().image = ImageId{99}; }));

    EXPECT_FALSE(encode_cluster({{ClusterId{1}, {}, 1, 0, 0, 0, {}, {}}, false}).ok());
    EXPECT_FALSE(
        encode_cluster({{ClusterId{1}, {ImageId{2}, ImageId{1}}, 1, 0, 0, 0, {}, {}}, false}).ok());
    EXPECT_FALSE(encode_cluster({{ClusterId{1}, {ImageId{2}}, 1, 2, 0, 0, {}, {}}, false}).ok());
    const std::vector<ImageId> own{ImageId{2}};
    EXPECT_FALSE(encode_cluster({{ClusterId{1}, own, 1, 1, 0, 0, {}, own}, false}).ok());

    SceneRecord scene = random_scene(rng);
    scene.scene.placements[0].world_from_cluster.scale = 0.0;
    EXPECT_FALSE(encode_scene(scene).ok());
    scene = random_scene(rng);
    std::swap(scene.scene.placements.front(), scene.scene.placements.back());
    EXPECT_FALSE(encode_scene(scene).ok());
}

/// Two points of two observations each; `shared` is one of both, if it is given.
std::vector<ScenePoint> two_points(std::uint32_t image, std::uint32_t feature, bool shared) {
    ScenePoint first;
    first.track = {{ImageId{1}, 5}, {ImageId{image}, feature}};
    ScenePoint second;
    second.track = {{ImageId{1}, 6}, {ImageId{image}, shared ? feature : feature - 1}};
    return {first, second};
}

TEST(RecordCodec, ChecksPointsWhateverTheirNumbers) {
    constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
    for (const auto& [image, feature] :
         {std::pair{2U, 7U}, {2U, kMost}, {kMost, 7U}, {kMost, kMost}, {1U << 22U, 1U}}) {
        EXPECT_TRUE(each_feature_in_one_point(two_points(image, feature, false))) << image;
        EXPECT_FALSE(each_feature_in_one_point(two_points(image, feature, true))) << image;
        Reconstruction poses;
        poses.images = {{ImageId{1}, CameraId{0}, {}}};
        EXPECT_FALSE(points_belong_to(two_points(image, feature, false), poses)) << image;
        poses.images.push_back({ImageId{image}, CameraId{0}, {}});
        EXPECT_TRUE(points_belong_to(two_points(image, feature, false), poses)) << image;
    }
    EXPECT_TRUE(each_feature_in_one_point({}));
    EXPECT_FALSE(points_belong_to(two_points(2, 7, false), {}));
}

}  // namespace
}  // namespace psfm
