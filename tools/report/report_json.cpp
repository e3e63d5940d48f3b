// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nlohmann/json.hpp>

#include "storage/exchange/files/json_text.h"
#include "tools/report/report_page.h"
#include "tools/report/status_json.h"

namespace psfm {
namespace {

using nlohmann::ordered_json;

ordered_json json_of(const Spread& spread) {
    return {{"count", spread.count},
            {"least", spread.least},
            {"largest", spread.largest},
            {"mean", spread.mean},
            {"median", spread.median}};
}

ordered_json json_of(const Camera& camera) {
    ordered_json parameters = ordered_json::array();
    for (int i = 0; i < parameter_count(camera.model); ++i)
        parameters.push_back(camera.params.at(static_cast<std::size_t>(i)));
    return {{"model", model_name(camera.model)},
            {"width", camera.width},
            {"height", camera.height},
            {"params", std::move(parameters)}};
}

ordered_json cameras_json(const ReportFacts& facts) {
    ordered_json cameras = ordered_json::array();
    for (const CameraFacts& camera : facts.cameras) {
        ordered_json after = ordered_json::array();
        for (const auto& [cluster, estimate] : camera.after)
            after.push_back({{"cluster", index_of(cluster)}, {"camera", json_of(estimate)}});
        ordered_json cells = ordered_json::array();
        for (const ResidualCell& cell : camera.cells) {
            cells.push_back({{"count", cell.count},
                             {"mean_x_px", cell.mean_px.x()},
                             {"mean_y_px", cell.mean_px.y()},
                             {"mean_length_px", cell.mean_length_px}});
        }
        cameras.push_back({{"id", index_of(camera.id)},
                           {"images", camera.images},
                           {"before", json_of(camera.before)},
                           {"after", std::move(after)},
                           {"mean_error_px", camera.mean_px},
                           {"residual_columns", CameraFacts::kColumns},
                           {"residual_rows", CameraFacts::kRows},
                           {"residual_cells", std::move(cells)}});
    }
    return cameras;
}

ordered_json positions_json(const ReportFacts& facts, const ReportOptions& options) {
    if (facts.position_errors.empty()) return {};
    ordered_json axes = ordered_json::array();
    for (const AxisError& error : facts.position_errors) {
        axes.push_back({{"axis", error.axis},
                        {"mean_m", error.mean},
                        {"sigma_m", error.sigma},
                        {"rms_m", error.rms}});
    }
    ordered_json positions{{"positions", facts.positions},
                           {"within_90_percent_m", facts.circular_90_m},
                           {"axes", std::move(axes)}};
    if (options.share_location && facts.reference) {
        positions["datum"] = {{"latitude_deg", facts.reference->datum.latitude_deg},
                              {"longitude_deg", facts.reference->datum.longitude_deg}};
    }
    return positions;
}

ordered_json history_json(const ReportFacts& facts) {
    ordered_json versions = ordered_json::array();
    for (const PastVersion& version : facts.session.versions) {
        const auto summary = decode_summary(version.summary_json);
        if (!summary.ok()) continue;  // Expected: damaged; told of where it is the latest
        versions.push_back({{"version", version.version},
                            {"images", summary->counts.images},
                            {"placed", summary->counts.placed},
                            {"parts", version.effective_clusters},
                            {"resets", summary->counts.resets}});
    }
    return versions;
}

ordered_json times_json(const ReportOptions& options) {
    if (!options.times) return {};
    ordered_json nodes = ordered_json::array();
    for (const RunTimes::Node& node : options.times->nodes) {
        nodes.push_back({{"node", node.name},
                         {"runs", node.runs},
                         {"busy_s", node.busy_s},
                         {"waiting_s", node.waiting_s},
                         {"work_s", node.work_s}});
    }
    return {{"images", options.times->images},
            {"median_latency_ms", options.times->median_latency_ms},
            {"p95_latency_ms", options.times->p95_latency_ms},
            {"stage_seconds", options.times->stage_seconds},
            {"seconds", options.times->seconds},
            {"threads", options.times->threads},
            {"nodes", std::move(nodes)}};
}

}  // namespace

std::string report_json(const ReportFacts& facts, const ReportOptions& options) {
    const SessionCounts& counts = facts.session.summary.counts;
    ordered_json edges = ordered_json::array();
    for (const EdgeFact& edge : facts.edges) {
        edges.push_back({index_of(edge.pair.first), index_of(edge.pair.second), edge.matches,
                         edge_state_name(edge.state)});
    }
    ordered_json lengths = ordered_json::object();
    for (const auto& [length, points] : facts.track_lengths)
        lengths[std::to_string(length)] = points;
    ordered_json parts = ordered_json::array();
    for (const PartFacts& part : facts.parts) {
        parts.push_back({{"part", part.number},
                         {"images", part.cameras.size()},
                         {"points", part.points},
                         {"clusters", part.clusters},
                         {"in_metres", part.in_metres}});
    }
    ordered_json images = ordered_json::array();
    for (const ImageFact& fact : facts.session.facts)
        images.push_back(parse_ordered_json(image_json(fact)));
    const ordered_json report{
        {"images", counts.images},
        {"placed", counts.placed},
        {"waiting", counts.waiting},
        {"rejected", counts.rejected},
        {"version", counts.version},
        {"resets", counts.resets},
        {"points", facts.points},
        {"observations", facts.observations},
        {"mean_track_length", facts.mean_track},
        {"mean_error_px", facts.mean_error_px},
        {"rms_error_px", facts.rms_error_px},
        {"error_histogram",
         {{"step_px", ReportFacts::kErrorStepPx}, {"counts", facts.error_histogram}}},
        {"track_lengths", std::move(lengths)},
        {"features", json_of(facts.features)},
        {"inliers", json_of(facts.inliers)},
        {"parts", std::move(parts)},
        {"cameras", cameras_json(facts)},
        {"edges", std::move(edges)},
        {"positions", positions_json(facts, options)},
        {"versions", history_json(facts)},
        {"weak_models", parse_ordered_json(weak_models_json(facts.session.summary))},
        {"times", times_json(options)},
        {"image_list", std::move(images)}};
    return json_text(report, 1) + "\n";
}

}  // namespace psfm
