// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/page_data.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "storage/exchange/files/json_text.h"
#include "tools/report/status_json.h"
#include "tools/report/up_direction.h"
#include "tools/serve/pages.h"
#include "tools/serve/wire.h"

namespace psfm {
namespace {

using nlohmann::ordered_json;

// Arrays of what there is much of, as text, without a tree of them.

std::string images_text(const PageSession& session) {
    std::string text = "[";
    for (const ImageFact& fact : session.facts->facts)
        text.append(text.size() > 1 ? "," : "").append(image_json(fact));
    return text + "]";
}

std::string edges_text(const PageSession& session) {
    std::string text = "[";
    for (const EdgeFact& edge : *session.edges) {
        text.append(text.size() > 1 ? ",[" : "[").append(std::to_string(index_of(edge.pair.first)));
        text.append(",").append(std::to_string(index_of(edge.pair.second)));
        text.append(",").append(std::to_string(edge.matches));
        text.append(",\"").append(edge_state_name(edge.state)).append("\"]");
    }
    return text + "]";
}

ordered_json versions_json(const SessionFacts& facts) {
    constexpr std::size_t kMost = 200;  // Format: what happened lately
    ordered_json versions = ordered_json::array();
    const std::size_t first = facts.versions.size() - std::min(facts.versions.size(), kMost);
    for (std::size_t i = first; i < facts.versions.size(); ++i) {
        const auto summary = decode_summary(facts.versions[i].summary_json);
        if (!summary.ok()) continue;  // Expected: damaged; told of where it is the latest
        versions.push_back({{"version", facts.versions[i].version},
                            {"images", summary->counts.images},
                            {"placed", summary->counts.placed},
                            {"parts", facts.versions[i].effective_clusters},
                            {"resets", summary->counts.resets}});
    }
    return versions;
}

}  // namespace

std::string session_json(const PageSession& session) {
    const SessionFacts& facts = *session.facts;
    const SessionCounts& counts = facts.summary.counts;
    ordered_json cameras = ordered_json::array();
    for (const auto& [id, camera] : session.cameras) {
        cameras.push_back({{"id", index_of(id)},
                           {"width", camera.width},
                           {"height", camera.height},
                           {"focal", camera.mean_focal()}});
    }
    ordered_json events = ordered_json::array();
    for (const PastEvent& event : facts.summary.events)
        events.push_back({{"image", event.image}, {"event", event.kind}, {"text", event.text}});
    ordered_json hints = ordered_json::array();
    for (const Hint& hint : session.hints) {
        hints.push_back(
            {{"kind", hint_name(hint.kind)}, {"image", index_of(hint.image)}, {"text", hint.text}});
    }
    const Eigen::Vector3d up = session.in_metres
                                   ? Eigen::Vector3d::UnitZ().eval()
                                   : up_direction(clusters_with_models(facts.scene), facts.images);
    ordered_json page{{"name", session.name},
                      {"counts",
                       {{"images", counts.images},
                        {"placed", counts.placed},
                        {"waiting", counts.waiting},
                        {"rejected", counts.rejected},
                        {"clusters", counts.clusters},
                        {"effective_clusters", counts.effective_clusters},
                        {"version", counts.version}}},
                      {"cameras", std::move(cameras)},
                      {"weak_models", parse_ordered_json(weak_models_json(facts.summary))},
                      {"events", std::move(events)},
                      {"versions", versions_json(facts)},
                      {"hints", std::move(hints)},
                      {"users", session.users},
                      {"in_metres", session.in_metres},
                      {"up", {up.x(), up.y(), up.z()}},
                      {"licence", page_file("three.LICENSE")}};
    if (!session.me.empty()) page["me"] = {{"name", session.me}, {"role", session.role}};
    std::string text = json_text(page);
    text.pop_back();
    return text + ",\"image_list\":" + images_text(session) + ",\"edges\":" + edges_text(session) +
           "}";
}

std::string tracks_bytes(const Scene& scene, const ShownScene& shown) {
    WireWriter writer;
    for (const auto& cluster : scene.clusters) {
        if (!cluster->model || cluster->model->points.empty()) continue;
        std::vector<const ScenePoint*> by_slot;
        for (const ScenePoint& point : cluster->model->points) {
            const auto slot = shown.slot_of(cluster->id, point.track.front());
            if (!slot) continue;
            if (by_slot.size() <= *slot) by_slot.resize(*slot + 1, nullptr);
            by_slot[*slot] = &point;
        }
        writer.leb(index_of(cluster->id));
        writer.leb(static_cast<std::uint32_t>(by_slot.size()));
        for (const ScenePoint* point : by_slot) {
            std::vector<std::uint32_t> images;
            if (point != nullptr) {
                for (const Observation& seen : point->track) images.push_back(index_of(seen.image));
            }
            writer.leb(static_cast<std::uint32_t>(images.size()));
            writer.ascending(images);
        }
    }
    return writer.take();
}

Colour FeatureColours::operator()(const Observation& feature) {
    constexpr Colour kGrey{128, 128, 128};  // Format: a colour of what has none
    auto known = known_.find(feature.image);
    if (known == known_.end()) {
        const auto keypoints = session_->keypoints(feature.image);
        if (!keypoints.ok()) return kGrey;  // Expected: `psfm check` names the damage
        std::vector<Colour> colours;
        colours.reserve((*keypoints)->size());
        for (const Keypoint& keypoint : **keypoints)
            colours.push_back({keypoint.red, keypoint.green, keypoint.blue});
        if (order_.size() >= kImages) {
            known_.erase(order_.front());
            order_.erase(order_.begin());
        }
        order_.push_back(feature.image);
        known = known_.emplace(feature.image, std::move(colours)).first;
    }
    return feature.feature < known->second.size() ? known->second[feature.feature] : kGrey;
}

}  // namespace psfm
