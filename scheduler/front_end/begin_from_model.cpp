// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/front_end/begin_from_model.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "scheduler/front_end/foreign_features.h"
#include "scheduler/session/encode_state.h"
#include "scheduler/session/file_stamp.h"
#include "scheduler/session/known_files.h"
#include "stages/algorithms/math/in_parallel.h"
#include "stages/clustering/batch_clusters.h"
#include "stages/verification/run_verification.h"

namespace psfm {
namespace {

/// Guard: photographs whose features are in memory at a time.
constexpr std::size_t kBatch = 16;

/// Cameras that images have, ascending: a model may list others.
std::vector<std::uint32_t> used_cameras(const ExportedModel& model) {
    std::set<std::uint32_t> used;
    for (const ExportedImage& image : model.images) used.insert(image.camera_id);
    return {used.begin(), used.end()};
}

/// Our ids of the model's images and cameras: their numbers, in the order of the model's ids.
class Numbers {
  public:
    explicit Numbers(const ExportedModel& model) {
        for (std::uint32_t i = 0; i < model.images.size(); ++i) image_[model.images[i].id] = i;
        for (const std::uint32_t id : used_cameras(model))
            camera_.emplace(id, static_cast<std::uint32_t>(camera_.size()));
    }
    ImageId image(std::uint32_t id) const { return ImageId{image_.at(id)}; }
    CameraId camera(std::uint32_t id) const { return CameraId{camera_.at(id)}; }

  private:
    std::map<std::uint32_t, std::uint32_t> image_;
    std::map<std::uint32_t, std::uint32_t> camera_;
};

/// COLMAP lets a point be seen twice in one image; the first feature counts here. Moves the others
/// out of an ascending track. @param repeated  for SessionConfig: see there
void take_repeated(std::vector<Observation>& track, std::vector<std::uint32_t>& repeated) {
    std::optional<Observation> kept;
    std::erase_if(track, [&](const Observation& seen) {
        if (!kept || kept->image != seen.image) {
            kept = seen;
            return false;
        }
        for (const std::uint32_t number : {index_of(seen.image), kept->feature, seen.feature})
            repeated.push_back(number);
        return true;
    });
}

/// The model as a solution of one cluster. @param repeated  takes up what is left out
std::shared_ptr<const Reconstruction> reconstruction_of(const ExportedModel& model,
                                                        const Numbers& numbers,
                                                        std::vector<std::uint32_t>& repeated) {
    auto result = std::make_shared<Reconstruction>();
    for (const std::uint32_t id : used_cameras(model)) {
        Camera given = model.find_camera(id)->camera;
        given.focal_source = FocalSource::kGiven;
        result->cameras.emplace(numbers.camera(id), given);
    }
    for (const ExportedImage& image : model.images) {
        result->images.push_back(
            {numbers.image(image.id), numbers.camera(image.camera_id), image.cam_from_world});
    }
    std::vector<ScenePoint> points;
    points.reserve(model.points.size());
    for (const ExportedPoint& point : model.points) {
        ScenePoint scene_point;
        scene_point.position = point.position;
        scene_point.error_px = static_cast<float>(std::max(0.0, point.error_px));
        for (const ExportedObservation& seen : point.track)
            scene_point.track.push_back({numbers.image(seen.image_id), seen.keypoint});
        std::ranges::sort(scene_point.track);
        take_repeated(scene_point.track, repeated);
        if (scene_point.track.size() >= 2) points.push_back(std::move(scene_point));
    }
    result->points = std::move(points);
    return result;
}

/// What float lacks of the places of an image's features; empty when nothing.
std::vector<float> remainders_of(const ExportedImage& image) {
    std::vector<float> remainders;
    remainders.reserve(2 * image.keypoints.size());
    for (const ExportedKeypoint& keypoint : image.keypoints) {
        for (const double place : {keypoint.x, keypoint.y})
            remainders.push_back(static_cast<float>(place - static_cast<float>(place)));
    }
    const bool is_exact = std::ranges::all_of(remainders, [](float r) { return r == 0.0F; });
    return is_exact ? std::vector<float>() : remainders;
}

/// Matches of each image with earlier ones: of the database, or of the points that both see.
using MatchesByPair = std::map<ImagePair, std::vector<FeatureMatch>>;

MatchesByPair matches_by_points(const Reconstruction& model) {
    MatchesByPair matches;
    for (const ScenePoint& point : model.points) {
        for (std::size_t a = 0; a < point.track.size(); ++a) {
            for (std::size_t b = a + 1; b < point.track.size(); ++b) {
                matches[{point.track[a].image, point.track[b].image}].push_back(
                    {point.track[a].feature, point.track[b].feature});
            }
        }
    }
    return matches;
}

class Import {
  public:
    Import(SessionStore& store, const ForeignModel& foreign, const StageOptions& options,
           std::uint64_t seed)
        : store_(store),
          foreign_(foreign),
          options_(options),
          seed_(seed),
          numbers_(foreign.model) {}

    Result<BegunSession> run(const std::function<void()>& progress) {
        begun_.images = foreign_.model.images.size();
        if (auto done = take_images(progress); !done.ok()) return done.error();
        const auto model =
            reconstruction_of(foreign_.model, numbers_, begun_.repeated_observations);
        begun_.points = model->points.size();
        if (auto done = take_pairs(*model); !done.ok()) return done.error();
        if (auto done = take_model(model); !done.ok()) return done.error();
        return begun_;
    }

  private:
    Result<void> take_images(const std::function<void()>& progress);
    Result<std::map<ImagePair, VerifiedPairPtr>> verified_pairs(const Reconstruction& model);
    Result<MatchesByPair> matches_of_database();
    Result<void> take_pairs(const Reconstruction& model);
    Result<void> take_model(const std::shared_ptr<const Reconstruction>& model);

    SessionStore& store_;
    const ForeignModel& foreign_;
    const StageOptions& options_;
    std::uint64_t seed_;
    Numbers numbers_;
    std::map<std::uint32_t, ImageId> of_database_id_;
    std::vector<ImageFeatures> images_;  // without descriptors
    std::vector<StoredCluster> clusters_;
    BegunSession begun_;
};

Result<void> Import::take_images(const std::function<void()>& progress) {
    const ExportedModel& model = foreign_.model;
    std::map<std::string, std::uint32_t> database_ids;
    if (foreign_.database != nullptr) {
        for (const DatabaseImage& image : foreign_.database->images())
            database_ids[image.name] = image.id;
    }
    for (std::size_t first = 0; first < model.images.size(); first += kBatch) {
        const std::size_t count = std::min(kBatch, model.images.size() - first);
        std::vector<Result<ForeignFeatures>> extracted(count, Error{});
        std::vector<ForeignImage> sources(count);
        for (std::size_t k = 0; k < count; ++k) {
            const ExportedImage& image = model.images[first + k];
            sources[k] = {&image, &model.find_camera(image.camera_id)->camera, std::nullopt};
            const auto known = database_ids.find(image.name);
            if (known != database_ids.end()) sources[k].database_id = known->second;
        }
        in_parallel(count, [&](std::size_t k) {
            extracted[k] = foreign_features(sources[k], foreign_, options_.features);
        });
        for (std::size_t k = 0; k < count; ++k) {
            if (!extracted[k]) return extracted[k].error();
            ExtractedPhoto& photo = extracted[k]->photo;
            const ExportedImage& from = *sources[k].image;
            if (extracted[k]->unread) begun_.unread.push_back(extracted[k]->unread->message);
            if (extracted[k]->is_unlike) begun_.unlike.push_back(from.name);
            Image image;
            image.id = ImageId{static_cast<std::uint32_t>(first + k)};
            image.camera = numbers_.camera(from.camera_id);
            image.name = from.name;
            image.metadata = photo.metadata;
            if (photo.descriptors.values.empty()) {
                photo.descriptors.values.resize(photo.keypoints.size() * Descriptors::kSize);
                begun_.without_descriptors.push_back(from.name);
            }
            Camera camera = *sources[k].camera;
            camera.focal_source = FocalSource::kGiven;
            ImageSource source;
            source.place_remainders = remainders_of(from);
            const PhotoFile file{foreign_.photo_folder / from.name, from.name};
            const auto stamp = stamp_of(file.path);
            const bool was_read =
                stamp && !extracted[k]->unread && has_photograph(foreign_.photo_folder, from.name);
            if (was_read) source.file = file_of(file, *stamp);
            auto done =
                store_.commit_image(image, camera, photo.keypoints, photo.descriptors, source);
            if (!done.ok()) return done.error();
            if (sources[k].database_id) of_database_id_[*sources[k].database_id] = image.id;
            images_.push_back({image.id, camera, image.metadata.content_hash,
                               std::make_shared<const Keypoints>(std::move(photo.keypoints)),
                               nullptr});
            progress();
        }
    }
    return {};
}

Result<MatchesByPair> Import::matches_of_database() {
    MatchesByPair matches;
    for (const auto& [database_id, image] : of_database_id_) {
        auto partners = foreign_.database->matches(database_id);
        if (!partners.ok()) return partners.error();
        for (DatabaseMatches& partner : *partners) {
            const auto other = of_database_id_.find(partner.other);
            if (other == of_database_id_.end() || image > other->second) continue;
            matches[{image, other->second}] = std::move(partner.matches);
        }
    }
    return matches;
}

Result<std::map<ImagePair, VerifiedPairPtr>> Import::verified_pairs(const Reconstruction& model) {
    auto matches = foreign_.database != nullptr && foreign_.database->verified_pairs() > 0
                       ? matches_of_database()
                       : Result<MatchesByPair>(matches_by_points(model));
    if (!matches.ok()) return matches.error();
    const auto& verify = options_.verification.verify;
    std::erase_if(*matches, [&](const auto& pair) {
        return pair.second.size() < static_cast<std::size_t>(verify.min_inliers);
    });
    std::vector<std::pair<ImagePair, const std::vector<FeatureMatch>*>> tasks;
    for (auto& [pair, found] : *matches) {
        std::ranges::sort(found);
        tasks.emplace_back(pair, &found);
    }
    std::vector<VerifiedPairPtr> verified(tasks.size());
    in_parallel(tasks.size(), [&](std::size_t t) {
        const auto& [pair, found] = tasks[t];
        auto geometry = verify_images(images_[index_of(pair.first)], images_[index_of(pair.second)],
                                      *found, verify, seed_);
        if (geometry.ok()) {  // Expected: a pair whose matches hold no geometry is none
            verified[t] =
                std::make_shared<const VerifiedPair>(VerifiedPair{pair, *std::move(geometry)});
        }
    });
    std::map<ImagePair, VerifiedPairPtr> pairs;
    for (std::size_t t = 0; t < tasks.size(); ++t) {
        if (verified[t]) pairs.emplace(tasks[t].first, std::move(verified[t]));
    }
    return pairs;
}

Result<void> Import::take_pairs(const Reconstruction& model) {
    const auto pairs = verified_pairs(model);
    if (!pairs.ok()) return pairs.error();
    begun_.pairs = pairs->size();
    std::vector<std::vector<VerifiedPairPtr>> of_image(images_.size());
    for (const auto& [pair, verified] : *pairs) of_image[index_of(pair.second)].push_back(verified);
    EdgeSelection edges;
    ViewGraph graph;
    for (std::uint32_t i = 0; i < images_.size(); ++i)
        select_edges(edges, graph, ImageId{i}, of_image[i], options_.edges);
    // One cluster, of which the model is the solution, is what they all come from.
    StoredCluster whole;
    for (std::uint32_t i = 0; i < images_.size(); ++i) whole.members.push_back(ImageId{i});
    whole.topology = 1;
    clusters_.push_back(whole);
    const auto components = batch_clusters(graph, options_.clustering);
    for (const auto& members : components) {
        if (components.size() == 1) break;
        StoredCluster part;
        part.id = static_cast<ClusterId>(clusters_.size());
        part.members = members;
        part.topology = 1;
        part.transfer_topology = 1;
        part.recycled = {{ClusterId{0}, 1}};
        clusters_.push_back(std::move(part));
    }
    begun_.clusters = components.size();
    for (std::uint32_t i = 0; i < images_.size(); ++i) {
        const bool last = i + 1 == images_.size();
        auto done = store_.commit_pairs(
            ImageId{i}, of_image[i],
            last ? std::vector<StoredCluster>{whole} : std::vector<StoredCluster>{}, {});
        if (!done.ok()) return done.error();
    }
    return {};
}

Result<void> Import::take_model(const std::shared_ptr<const Reconstruction>& model) {
    StoredCluster& whole = clusters_.front();
    whole.solved_topology = 1;
    whole.revision = 1;
    SolveState state;
    state.images_at_full_adjustment = static_cast<std::uint32_t>(model->images.size());
    state.images_at_start = state.images_at_full_adjustment;
    StoredSolution solution;
    solution.cluster = whole.id;
    solution.revision = 1;
    solution.model = model;
    // Nothing is adjusted before something new has come along.
    solution.state_json = encode_solve_state({state, /*settled=*/true});
    if (auto done = store_.commit_solution(solution, whole, {}); !done.ok()) return done.error();

    StoredSceneVersion version;
    version.version = 1;
    version.image_count = static_cast<std::uint32_t>(images_.size());
    version.effective_clusters = 1;
    version.placements = {{whole.id, 1, whole.members, Sim3{}, 0}};
    SceneSummary summary;
    summary.counts.images = version.image_count;
    summary.counts.placed = version.image_count;
    summary.counts.clusters = static_cast<std::uint32_t>(begun_.clusters);
    summary.counts.effective_clusters = 1;
    summary.counts.version = 1;
    version.summary_json = encode_summary(summary);
    if (auto done = store_.commit_scene(version, {}); !done.ok()) return done.error();
    if (clusters_.size() == 1) return {};
    StoredEdit split;
    split.changed.assign(clusters_.begin() + 1, clusters_.end());
    split.removed = {whole.id};
    return store_.commit_clusters(split);
}

}  // namespace

void remember_model(const ExportedModel& model, SessionConfig& config) {
    // Guard: of a large model some evenly chosen images hold its frame as well as all.
    constexpr std::size_t kAnchors = 200;
    const std::size_t stride = (model.images.size() + kAnchors - 1) / kAnchors;
    for (std::size_t i = 0; i < model.images.size(); ++i) {
        config.image_ids.push_back(model.images[i].id);
        if (i % stride == 0)
            config.anchors.push_back({static_cast<ImageId>(i), model.images[i].cam_from_world});
    }
    config.camera_ids = used_cameras(model);
}

Result<BegunSession> begin_from_model(SessionStore& store, const ForeignModel& foreign,
                                      const SessionConfig& config,
                                      const std::function<void()>& progress) {
    const auto options = stage_options(config);
    if (!options.ok()) return options.error();
    Import import(store, foreign, *options, config.seed);
    return import.run(progress);
}

}  // namespace psfm
