// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What is read of a session.
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scheduler/session/photo_folders.h"
#include "storage/exchange/files/json_text.h"
#include "tools/report/residuals.h"
#include "tools/serve/api.h"
#include "tools/serve/gzip.h"
#include "tools/serve/replay.h"
#include "tools/serve/uploads/upload_files.h"

namespace psfm {
namespace {

using nlohmann::ordered_json;

constexpr std::string_view kOctets = "application/octet-stream";

std::optional<std::uint32_t> id_in(std::string_view text) {
    const auto number = number_in(text);
    if (!number || *number > 0xffffffffU) return std::nullopt;
    return static_cast<std::uint32_t>(*number);
}

HttpResponse octets(const LiveSession::Bytes& bytes, const HttpRequest& request) {
    HttpResponse response;
    response.headers = {{"Content-Type", std::string(kOctets)},
                        {"Cache-Control", "no-cache"},
                        {"Vary", "Accept-Encoding"},
                        {"ETag", '"' + std::to_string(bytes.number) + '"'}};
    if (request.header("accept-encoding").find("gzip") != std::string_view::npos) {
        response.headers.emplace_back("Content-Encoding", "gzip");
        response.body = bytes.gzip;
    } else {
        response.body = bytes.plain;
    }
    return response;
}

const SceneCluster* cluster_with(const Scene& scene, ImageId image) {
    for (const auto& cluster : scene.clusters) {
        if (cluster->model && cluster->model->find(image) != nullptr) return cluster.get();
    }
    return nullptr;
}

}  // namespace

HttpPlan Api::plan_read(const HttpRequest& head, const User& user) {
    if (head.method != "GET" && head.method != "HEAD")
        return at_once(problem(405, "this is only read"));
    const auto parts = parts_of(head.path);  // "", "api", "v1", …
    const std::string& what = parts.size() > 3 ? parts[3] : parts[0];
    const auto id = [&](std::size_t k) {
        return parts.size() > k ? id_in(parts[k]) : std::nullopt;
    };
    const auto of_model = [](auto work) { return by_work(std::move(work), Lane::kModel); };
    if (parts.size() == 4) {
        if (what == "events") {
            if (head.method == "HEAD") return at_once(problem(405, "a stream has no end to tell"));
            HttpPlan plan;
            plan.events = true;
            return plan;
        }
        if (what == "session")
            return by_work([this, user](const HttpRequest& r) { return session(user, r); });
        if (what == "scene") return of_model([this](const HttpRequest& r) { return scene(r); });
        if (what == "replay") return of_model([this](const HttpRequest& r) { return replay(r); });
    }
    if (parts.size() == 5 && what == "scene" && parts[4] == "changes")
        return by_work([this](const HttpRequest& r) { return changes(r); });
    if (parts.size() == 5 && what == "images" && id(4))
        return of_model([this, k = *id(4)](const HttpRequest&) { return image(k); });
    if (parts.size() == 6 && what == "images" && id(4) && parts[5] == "thumbnail") {
        return by_work([this, k = *id(4)](const HttpRequest&) { return thumbnail(k); },
                       Lane::kPhotograph);
    }
    if (parts.size() == 6 && what == "points" && id(4) && id(5))
        return of_model([this, a = *id(4), b = *id(5)](const HttpRequest&) { return point(a, b); });
    if (parts.size() == 6 && what == "pairs" && id(4) && id(5))
        return of_model([this, a = *id(4), b = *id(5)](const HttpRequest&) { return pair(a, b); });
    return at_once(problem(404, "there is nothing of this name in the API"));
}

HttpResponse Api::session(const User& user, const HttpRequest& request) const {
    const auto text = parts_.live->session(user.name, std::string(role_name(user.role)));
    if (!text.plain) return problem(503, "the session cannot be read at the moment; try again");
    HttpResponse response = json_response(200, {});
    response.headers.emplace_back("Vary", "Accept-Encoding");
    if (request.header("accept-encoding").find("gzip") != std::string_view::npos) {
        response.headers.emplace_back("Content-Encoding", "gzip");
        response.body = text.gzip;
    } else {
        response.body = text.plain;
    }
    return response;
}

HttpResponse Api::scene(const HttpRequest& request) const {
    return octets(parts_.live->scene(), request);
}

HttpResponse Api::changes(const HttpRequest& request) const {
    const auto after = request.query.find("after");
    const auto number = after == request.query.end() ? std::nullopt : id_in(after->second);
    if (!number) return problem(400, "after= wants the number of the last change");
    const auto bytes = parts_.live->changes(*number);
    if (!bytes) return problem(410, "these changes are not kept any more; GET scene has all of it");
    return octets(*bytes, request);
}

HttpResponse Api::replay(const HttpRequest& request) {
    const ScenePtr scene = parts_.live->scene_version();
    const std::uint64_t version = scene ? scene->version : 0;
    if (!replay_ || replay_version_ != version) {
        auto bytes = replay_bytes(*parts_.reader);
        if (!bytes.ok()) return problem(503, bytes.error().message);
        replay_gzip_ = std::make_shared<const std::string>(gzipped(*bytes));
        replay_ = std::make_shared<const std::string>(*std::move(bytes));
        replay_version_ = version;
    }
    return octets({replay_, replay_gzip_, static_cast<std::uint32_t>(version)}, request);
}

HttpResponse Api::point(std::uint32_t cluster, std::uint32_t slot) const {
    const auto key = parts_.live->key_of(static_cast<ClusterId>(cluster), slot);
    const ScenePtr scene = parts_.live->scene_version();
    if (!key || !scene) return problem(404, "there is no such point");
    for (const auto& one : scene->clusters) {
        if (index_of(one->id) != cluster || !one->model) continue;
        std::shared_ptr<const Reconstruction> model = one->model;
        if (model->points.empty()) {  // the cluster rests
            auto stored = parts_.reader->recycled_model({one->id, one->revision});
            if (!stored.ok()) return problem(503, stored.error().message);
            if (*stored) model = *stored;
        }
        for (const ScenePoint& point : model->points) {
            if (point.track.front() != *key) continue;
            ordered_json images = ordered_json::array();
            for (const Observation& seen : point.track) images.push_back(index_of(seen.image));
            return json_response(200,
                                 json_text(nlohmann::ordered_json{{"images", std::move(images)},
                                                                  {"error_px", point.error_px}}));
        }
    }
    return problem(404, "there is no such point any more");
}

HttpResponse Api::image(std::uint32_t image) const {
    const ScenePtr scene = parts_.live->scene_version();
    const auto id = static_cast<ImageId>(image);
    const SceneCluster* cluster = scene ? cluster_with(*scene, id) : nullptr;
    if (cluster == nullptr) return problem(404, "this image is in no model");
    std::shared_ptr<const Reconstruction> model = cluster->model;
    if (model->points.empty()) {
        auto stored = parts_.reader->recycled_model({cluster->id, cluster->revision});
        if (!stored.ok()) return problem(503, stored.error().message);
        if (*stored) model = *stored;
    }
    // The image's own part of the model, so that other images' features stay unread.
    Reconstruction own;
    own.images = {*model->find(id)};
    own.cameras = model->cameras;
    std::vector<ScenePoint> points;
    std::vector<Observation> firsts;
    for (const ScenePoint& point : model->points) {
        const auto seen = std::ranges::find(point.track, id, &Observation::image);
        if (seen == point.track.end()) continue;
        points.push_back({point.position, point.error_px, {*seen}});
        firsts.push_back(point.track.front());
    }
    own.points = ScenePoints(std::move(points));
    const auto residuals =
        residuals_of(own, [&](ImageId one) { return parts_.reader->keypoints(one); });
    if (!residuals.ok()) return problem(503, residuals.error().message);
    ordered_json observations = ordered_json::array();
    for (const Residual& residual : residuals->front()) {
        const auto slot = parts_.live->slot_of(cluster->id, firsts[residual.point]);
        observations.push_back({{"x", residual.observed_px.x()},
                                {"y", residual.observed_px.y()},
                                {"dx", residual.difference_px.x()},
                                {"dy", residual.difference_px.y()},
                                {"cluster", index_of(cluster->id)},
                                {"slot", slot ? ordered_json(*slot) : ordered_json()}});
    }
    return json_response(
        200, json_text(nlohmann::ordered_json{{"observations", std::move(observations)}}));
}

HttpResponse Api::pair(std::uint32_t first, std::uint32_t second) const {
    if (first >= second) return problem(400, "the first image of a pair has the smaller number");
    const auto verified = parts_.reader->verified_image_count();
    if (!verified.ok()) return problem(503, verified.error().message);
    if (second >= *verified) return problem(404, "there is no such pair");
    const auto pairs = parts_.reader->pairs_of(static_cast<ImageId>(second));
    if (!pairs.ok()) return problem(503, pairs.error().message);
    for (const VerifiedPairPtr& pair : *pairs) {
        if (index_of(pair->pair.first) != first) continue;
        const auto a = parts_.reader->keypoints(pair->pair.first);
        const auto b = parts_.reader->keypoints(pair->pair.second);
        if (!a.ok()) return problem(503, a.error().message);
        if (!b.ok()) return problem(503, b.error().message);
        ordered_json matches = ordered_json::array();
        for (const FeatureMatch& match : pair->geometry.inliers) {
            if (match.first >= (*a)->size() || match.second >= (*b)->size()) continue;
            const Keypoint& one = (**a)[match.first];
            const Keypoint& two = (**b)[match.second];
            matches.push_back({{"x1", one.x}, {"y1", one.y}, {"x2", two.x}, {"y2", two.y}});
        }
        return json_response(200,
                             json_text(nlohmann::ordered_json{{"matches", std::move(matches)}}));
    }
    return problem(404, "there is no such pair");
}

HttpResponse Api::thumbnail(std::uint32_t image) const {
    const auto fact = parts_.live->fact_of(static_cast<ImageId>(image));
    if (!fact || !parts_.thumbnail) return problem(404, "there is no such image");
    const auto folders = photo_folders(*parts_.reader, parts_.session);
    // Expected: without them it is not known where the photograph lies
    const auto photo = folders.ok() ? find_photo(*folders, fact->name) : std::nullopt;
    if (!photo) return problem(404, "this photograph is not where the session had it");
    const std::filesystem::path kept = thumbnail_file(parts_.session, fact->name);
    std::string bytes;
    if (std::ifstream stream(kept, std::ios::binary); stream) {
        bytes.assign(std::istreambuf_iterator<char>(stream), {});
    } else if (auto made = parts_.thumbnail(*photo)) {
        bytes = *std::move(made);
        if (parts_.uploads != nullptr) {  // a session that is only looked at is left alone
            std::error_code ignored;
            std::filesystem::create_directories(kept.parent_path(), ignored);
            const std::filesystem::path part = kept.string() + ".part";
            std::ofstream(part, std::ios::binary) << bytes;
            std::filesystem::rename(part, kept, ignored);
        }
    }
    if (bytes.empty()) return problem(404, "no thumbnail can be made of this photograph");
    HttpResponse response;
    response.headers = {{"Content-Type", "image/jpeg"},
                        {"Cache-Control", "private, max-age=86400"}};
    response.body = std::make_shared<const std::string>(std::move(bytes));
    return response;
}

}  // namespace psfm
