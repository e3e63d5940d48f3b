// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <stdexcept>

#include "scheduler/session/encode_state.h"
#include "scheduler/session/session_config.h"
#include "storage/records/cluster_records.h"
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"
#include "storage/records/record_envelope.h"
#include "storage/records/record_key.h"
#include "storage/records/scene_records.h"
#include "storage/records/solution_records.h"
#include "storage/session/session_store.h"
#include "tests/fuzz/seeds.h"
#include "tests/storage/exchange/example_model.h"
#include "tests/storage/random_values.h"

namespace psfm::fuzz {
namespace {

using testing::Rng;

void write_record(const SeedFolder& seeds, RecordKind kind, std::string_view key,
                  const Result<std::string>& payload) {
    if (!payload.ok()) throw std::runtime_error(payload.error().message);
    const char kind_byte = static_cast<char>(kind);
    const std::string name =
        std::string(describe(kind)) + " " + std::to_string(static_cast<int>(key.back()));
    seeds.write("records", name, std::string(1, kind_byte) + *payload);
    const std::string header{kind_byte, static_cast<char>(key.size())};
    seeds.write("record_key", name,
                header + std::string(key) + seal_record(kind, key, payload->substr(0, 32)));
}

void write_payloads(const SeedFolder& seeds) {
    Rng rng(3);
    const std::string image_key = encode_key(ImageId{5});
    write_record(seeds, RecordKind::kSettings, settings_key(),
                 encode_settings({"/photos", "{\"version\":1}"}));
    write_record(seeds, RecordKind::kCamera, camera_key(CameraId{2}),
                 encode_camera(testing::random_camera(rng)));
    write_record(seeds, RecordKind::kRejected, rejected_key("a.jpg"),
                 encode_rejected({"a.jpg", "is too small", 77, 1234}));
    write_record(seeds, RecordKind::kImage, image_key,
                 encode_image(testing::random_image(ImageId{5}, rng)));
    write_record(seeds, RecordKind::kKeypoints, image_key,
                 encode_keypoints(testing::random_keypoints(3, rng)));
    write_record(seeds, RecordKind::kDescriptors, image_key,
                 encode_descriptors(testing::random_descriptors(2, rng)));
    const ImageId image{1'000'000};
    write_record(seeds, RecordKind::kPairs, encode_key(image),
                 encode_pairs(image, {testing::random_pair(ImageId{1}, image, 6, rng),
                                      testing::random_pair(ImageId{4}, image, 6, rng)}));
    ClusterRecord cluster;
    cluster.cluster.id = ClusterId{7};
    cluster.cluster.members = testing::first_images(6);
    cluster.cluster.topology = 4;
    cluster.cluster.solved_topology = 3;
    cluster.cluster.transfer_topology = 4;
    cluster.cluster.abandoned = cluster.cluster.at_rest = true;
    cluster.cluster.recycled = {{ClusterId{2}, 9}};
    cluster.cluster.adopted = {ImageId{8}, ImageId{10}};
    write_record(seeds, RecordKind::kCluster, encode_key(ClusterId{7}), encode_cluster(cluster));
    const Reconstruction model = testing::random_model(testing::first_images(4), 8, rng);
    const std::string solution_key = encode_key(SolutionKey{ClusterId{7}, 3});
    write_record(seeds, RecordKind::kPoses, solution_key, encode_poses(model));
    write_record(seeds, RecordKind::kPoints, solution_key, encode_points(model, "{}"));
    const Reconstruction smaller = restricted_to(model, testing::first_images(3));
    const Succession succession{std::make_shared<const Reconstruction>(smaller),
                                std::vector<std::uint8_t>(smaller.points.size(), 1)};
    write_record(seeds, RecordKind::kPoses, encode_key(SolutionKey{ClusterId{7}, 4}),
                 encode_changed_poses(model, smaller, 3));
    write_record(seeds, RecordKind::kPoints, encode_key(SolutionKey{ClusterId{7}, 4}),
                 encode_changed_points(model, "{}", succession, 3));
    const SolutionKey superseded{ClusterId{7}, 9};
    write_record(seeds, RecordKind::kSuperseded, superseded_key(superseded),
                 encode_superseded(superseded, 5));
    SceneRecord scene;
    scene.scene.version = 3;
    scene.scene.image_count = 100;
    scene.scene.effective_clusters = 1;
    scene.scene.summary_json = "{}";
    scene.scene.placements = {
        {ClusterId{7}, 3, testing::first_images(4), testing::random_similarity(rng), 0}};
    scene.points_kept = {true};
    write_record(seeds, RecordKind::kScene, encode_key(SceneKey{100, 3}), encode_scene(scene));
}

/// The logs of a session that nobody has closed.
void write_logs(const SeedFolder& seeds) {
    const test::TemporaryFolder folder;
    auto store = SessionStore::open(folder.path() / "session", {});
    if (!store.ok()) throw std::runtime_error(store.error().message);
    bool written = (*store)->put_settings({"/photos", "{}"}).ok();
    for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) {
        written = written && (*store)->commit_rejected({name, "is too small", 1, 2}).ok();
    }
    if (!written) throw std::runtime_error("cannot write a session");
    for (const auto& entry :
         std::filesystem::directory_iterator(folder.path() / "session" / "db")) {
        const std::string name = entry.path().filename().string();
        if (!name.ends_with(".log") && !name.starts_with("MANIFEST")) continue;
        seeds.write("log_structure", name, file_contents(entry.path()));
    }
}

void write_json(const SeedFolder& seeds) {
    SessionConfig config;
    seeds.write("session_json", "config", encode_config(config));
    config.preset = "paper";
    config.order = {"a.jpg", "b/c.jpg"};
    config.seed = 5;
    config.given_cameras["a.jpg"] = {"key", make_camera(640, 480, 500.0, FocalSource::kGiven)};
    seeds.write("session_json", "config_full", encode_config(config));
    SceneSummary summary;
    summary.counts.images = 3;
    summary.waiting = {{ImageId{1}, WaitReason{}}};
    summary.events.push_back({1, "join", "clusters 0 and 1"});
    seeds.write("session_json", "summary", encode_summary(summary));
    StoredSolveState state;
    state.state.images_at_full_adjustment = 7;
    state.settled = true;
    seeds.write("session_json", "solve_state", encode_solve_state(state));
}

}  // namespace

void write_record_seeds(const SeedFolder& seeds) {
    write_payloads(seeds);
    write_logs(seeds);
    write_json(seeds);
}

}  // namespace psfm::fuzz
