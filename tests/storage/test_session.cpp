// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/storage/test_session.h"

#include <cstdlib>
#include <stdexcept>

#include "tests/storage/random_values.h"

namespace psfm::testing {
namespace {

Rng rng_for(std::uint32_t image, std::uint32_t what) {
    return Rng(1000 * image + what);
}

std::uint32_t revision_after(std::uint32_t image) {
    return image + 2 - kFirstSolved;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
    // In memory where that can be had: the tests sync thousands of times.
    const std::filesystem::path memory = "/dev/shm";
    std::error_code ignored;
    const bool use_memory = std::filesystem::space(memory, ignored).available > (64U << 20U);
    const std::filesystem::path parent =
        use_memory && !ignored ? memory : std::filesystem::temp_directory_path();
    std::string name = (parent / "psfm-storage-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

Image expected_image(std::uint32_t image) {
    Rng rng = rng_for(image, 1);
    Image value = random_image(static_cast<ImageId>(image), rng);
    value.camera = CameraId{0};
    return value;
}

Camera expected_camera() {
    Rng rng(7);
    return random_camera(rng);
}

Keypoints expected_keypoints(std::uint32_t image) {
    Rng rng = rng_for(image, 2);
    return random_keypoints(kFeatures, rng);
}

Descriptors expected_descriptors(std::uint32_t image) {
    Rng rng = rng_for(image, 3);
    return random_descriptors(kFeatures, rng);
}

std::vector<VerifiedPairPtr> expected_pairs(std::uint32_t image) {
    Rng rng = rng_for(image, 4);
    std::vector<VerifiedPairPtr> pairs;
    for (std::uint32_t other = image < 3 ? 0 : image - 3; other < image; ++other) {
        pairs.push_back(
            random_pair(static_cast<ImageId>(other), static_cast<ImageId>(image), kFeatures, rng));
    }
    return pairs;
}

StoredCluster expected_cluster(std::uint32_t image, bool solved) {
    StoredCluster cluster;
    cluster.id = ClusterId{0};
    cluster.members = first_images(image + 1);
    cluster.topology = image + 1;
    const bool ever_solved = image + 1 >= kFirstSolved + (solved ? 0U : 1U);
    cluster.solved_topology = ever_solved ? (solved ? image + 1 : image) : 0;
    cluster.revision = ever_solved ? revision_after(solved ? image : image - 1) : 0;
    return cluster;
}

StoredSolution expected_solution(std::uint32_t image) {
    Rng rng = rng_for(image, 5);
    StoredSolution solution;
    solution.cluster = ClusterId{0};
    solution.revision = revision_after(image);
    solution.model = std::make_shared<const Reconstruction>(
        random_model(first_images(image + 1), kFeatures, rng));
    solution.state_json = "{\"image\":" + std::to_string(image) + "}";
    return solution;
}

StoredSceneVersion expected_scene(std::uint32_t image) {
    Rng rng = rng_for(image, 6);
    StoredSceneVersion scene;
    scene.version = image + 1;
    scene.image_count = image + 1;
    scene.summary_json = "{\"version\":" + std::to_string(image + 1) + "}";
    const bool solved = image + 1 >= kFirstSolved;
    scene.effective_clusters = solved ? 1 : 0;
    scene.placements.push_back({ClusterId{0}, solved ? revision_after(image) : 0,
                                first_images(image + 1), random_similarity(rng), 0});
    return scene;
}

bool commit_all(SessionStore& store, std::uint32_t image) {
    const auto id = static_cast<ImageId>(image);
    if (!store.commit_image(expected_image(image), expected_camera(), expected_keypoints(image),
                            expected_descriptors(image))) {
        return false;
    }
    if (!store.commit_pairs(id, expected_pairs(image), {expected_cluster(image, false)}, {})) {
        return false;
    }
    if (image + 1 >= kFirstSolved) {
        if (!store.commit_solution(expected_solution(image), expected_cluster(image, true), {})) {
            return false;
        }
    }
    return store.commit_scene(expected_scene(image), {}).ok();
}

bool finish(SessionStore& store, std::uint32_t images) {
    const auto count = static_cast<std::uint32_t>(store.images()->size());
    if (count > 0) {
        const std::uint32_t last = count - 1;
        if (*store.verified_image_count() < count &&
            !store.commit_pairs(static_cast<ImageId>(last), expected_pairs(last),
                                {expected_cluster(last, false)}, {})) {
            return false;
        }
        if (count >= kFirstSolved && store.clusters()->front().solved_topology < count &&
            !store.commit_solution(expected_solution(last), expected_cluster(last, true), {})) {
            return false;
        }
        if (store.scene()->version < count && !store.commit_scene(expected_scene(last), {})) {
            return false;
        }
    }
    for (std::uint32_t image = count; image < images; ++image) {
        if (!commit_all(store, image)) return false;
    }
    return true;
}

namespace {

std::string features_difference(const SessionReader& session, std::uint32_t image) {
    const auto id = static_cast<ImageId>(image);
    const auto keypoints = session.keypoints(id);
    if (!keypoints) return keypoints.error().message;
    if (**keypoints != expected_keypoints(image)) return "keypoints differ";
    const auto descriptors = session.descriptors(id);
    if (!descriptors) return descriptors.error().message;
    if (**descriptors != expected_descriptors(image)) return "descriptors differ";
    return "";
}

std::string pairs_difference(const SessionReader& session, std::uint32_t image) {
    const auto pairs = session.pairs_of(static_cast<ImageId>(image));
    if (!pairs) return pairs.error().message;
    const auto expected = expected_pairs(image);
    if (pairs->size() != expected.size()) return "number of pairs differs";
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (!same(*(*pairs)[i], *expected[i])) return "pair differs";
    }
    return "";
}

std::string cluster_difference(const SessionReader& session) {
    const auto clusters = session.clusters();
    if (!clusters) return clusters.error().message;
    if (clusters->empty()) return "";
    const StoredCluster& cluster = clusters->front();
    const std::uint32_t image = cluster.topology - 1;
    const bool solved = cluster.solved_topology == cluster.topology;
    if (!same(cluster, expected_cluster(image, solved))) return "cluster differs";
    if (cluster.revision == 0) return "";
    const auto solution = session.solution(ClusterId{0});
    if (!solution) return solution.error().message;
    if (!solution->has_value()) return "solution is missing";
    const std::uint32_t solved_image = (*solution)->revision + kFirstSolved - 2;
    const StoredSolution expected = expected_solution(solved_image);
    if ((*solution)->state_json != expected.state_json) return "state differs";
    if (!same_poses(*(*solution)->model, *expected.model)) return "poses of solution differ";
    if (!same_points(*(*solution)->model, *expected.model)) return "points of solution differ";
    return "";
}

std::string scene_difference(const SessionReader& session) {
    const auto scene = session.scene();
    if (!scene) return scene.error().message;
    if (scene->version == 0) return scene->clusters.empty() ? "" : "clusters of nothing";
    const auto image = static_cast<std::uint32_t>(scene->version) - 1;
    const StoredSceneVersion expected = expected_scene(image);
    if (scene->image_count != expected.image_count) return "scene's image count differs";
    if (scene->clusters.size() != 1) return "scene's cluster count differs";
    const SceneCluster& cluster = *scene->clusters.front();
    const StoredPlacement& placement = expected.placements.front();
    if (cluster.members != placement.members || cluster.revision != placement.revision ||
        !same(cluster.world_from_cluster, placement.world_from_cluster)) {
        return "placement differs";
    }
    if (placement.revision == 0) return cluster.model ? "model of nothing" : "";
    if (!same_poses(*cluster.model, *expected_solution(image).model)) return "scene's poses differ";
    if (!same_points(*cluster.model, *expected_solution(image).model)) {
        return "scene's points differ";
    }
    return "";
}

}  // namespace

std::string difference(const SessionReader& session) {
    const auto images = session.images();
    if (!images) return images.error().message;
    for (const Image& image : *images) {
        const std::uint32_t id = index_of(image.id);
        if (!same(image, expected_image(id))) return "image differs";
        if (const std::string text = features_difference(session, id); !text.empty()) return text;
    }
    const auto verified = session.verified_image_count();
    if (!verified) return verified.error().message;
    for (std::uint32_t id = 0; id < *verified; ++id) {
        if (const std::string text = pairs_difference(session, id); !text.empty()) return text;
    }
    if (const std::string text = cluster_difference(session); !text.empty()) return text;
    return scene_difference(session);
}

bool solve_successor(SessionStore& store, const std::vector<ImageId>& images,
                     StoredSceneVersion scene) {
    Rng rng(3);
    const auto model = std::make_shared<const Reconstruction>(random_model(images, 10, rng));
    const StoredCluster solved{ClusterId{1}, images, 1, 1, 1, 0, {}, {}};
    scene.version += 1;
    scene.placements.front().revision = 1;
    return store.commit_solution({ClusterId{1}, 1, model, ""}, solved, {}) &&
           store.commit_scene(scene, {});
}

}  // namespace psfm::testing
