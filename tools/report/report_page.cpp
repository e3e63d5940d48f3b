// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/report_page.h"

#include <algorithm>
#include <map>

#include "graph/wording.h"
#include "tools/report/html_table.h"
#include "tools/report/report_plots.h"
#include "tools/report/report_style.h"
#include "tools/report/svg.h"

namespace psfm {
namespace {

/// Format: what a page has room for.
constexpr std::size_t kMostEdges = 4000;  // drawn: 200 KB
constexpr std::size_t kMostParts = 8;     // with plots of their own
constexpr std::size_t kMostNames = 40;    // after a reason

std::string section(const std::string& title, const std::string& explanation) {
    return "<h2>" + escaped(title) + "</h2>\n<p class=\"explains\">" + escaped(explanation) +
           "</p>\n";
}

std::string number(double value, int digits) {
    return short_number(value, digits);
}

std::string weak_models(const SceneSummary& summary) {
    std::string items;
    for (const WeakModel& model : summary.weak) {
        for (const std::string& line : describe(model)) items += "<li>" + escaped(line) + "</li>\n";
    }
    return items.empty() ? items : "<ul class=\"weak\">\n" + items + "</ul>\n";
}

std::string overview(const ReportFacts& facts) {
    const SessionCounts& counts = facts.session.summary.counts;
    HtmlTable table({"", ""});
    const auto row = [&](const std::string& name, const std::string& value) {
        table.row({name, value});
    };
    row("photographs placed",
        std::to_string(counts.placed) + " of " + std::to_string(counts.images) + " accepted");
    row("waiting, rejected",
        std::to_string(counts.waiting) + ", " + std::to_string(counts.rejected));
    row("parts that stand alone", std::to_string(facts.parts.size()));
    row("clusters", std::to_string(counts.clusters));
    row("points", std::to_string(facts.points));
    row("observations", std::to_string(facts.observations));
    row("mean reprojection error", number(facts.mean_error_px, 3) + " px (root of mean square " +
                                       number(facts.rms_error_px, 3) + " px)");
    row("mean track length", number(facts.mean_track, 2) + " images");
    row("features an image", "median " + number(facts.features.median, 0) + ", from " +
                                 number(facts.features.least, 0) + " to " +
                                 number(facts.features.largest, 0));
    row("of these in the model", "median " + number(facts.inliers.median, 0) + ", from " +
                                     number(facts.inliers.least, 0) + " to " +
                                     number(facts.inliers.largest, 0));
    row("verified pairs", std::to_string(facts.edges.size()));
    row("resets", std::to_string(counts.resets));
    row("version", std::to_string(counts.version));
    return "<h2>Overview</h2>\n<p class=\"explains\">A photograph is placed when its camera's "
           "position is known; parts are models that nothing connects yet; a track is one point of "
           "the world as several photographs see it.</p>\n" +
           table.finish() + weak_models(facts.session.summary);
}

std::string not_placed(const ReportFacts& facts) {
    struct Group {
        std::string advice;
        std::vector<std::string> names;
    };
    std::map<std::string, Group> groups;
    for (const ImageFact& fact : facts.session.facts) {
        if (fact.state == ImageState::kPlaced) continue;
        const bool is_rejected = fact.state == ImageState::kRejected;
        Group& group = groups[(is_rejected ? "rejected: " : "") + fact.words];
        group.advice = fact.advice;
        group.names.push_back(fact.shown_name());
    }
    std::string html = section("Not placed, and why",
                               "No photograph is dropped in silence: each that is in no model has "
                               "a reason, and something that can be done.");
    if (groups.empty()) return html + "<p>Every photograph is placed.</p>\n";
    HtmlTable table({"photographs", "reason", "what to do", "names"});
    for (const auto& [reason, group] : groups) {
        std::string names;
        for (std::size_t i = 0; i < std::min(group.names.size(), kMostNames); ++i)
            names += (i > 0 ? ", " : "") + group.names[i];
        if (group.names.size() > kMostNames) names += ", …";
        table.row({std::to_string(group.names.size()), reason, group.advice, names});
    }
    return html + table.finish();
}

std::string parts(const ReportFacts& facts) {
    std::string html = section(
        "Coverage from above",
        "Points looked at along the mean up direction of the photographs: darker where there are "
        "more. Dots are cameras. Where the ground is empty between cameras, photographs are "
        "missing "
        "or nothing could be matched.");
    for (std::size_t i = 0; i < std::min(facts.parts.size(), kMostParts); ++i) {
        const PartFacts& part = facts.parts[i];
        html += "<h3>Part " + std::to_string(part.number) + ": " +
                counted(part.cameras.size(), "photograph") + ", " + counted(part.points, "point") +
                ", " + counted(part.clusters, "cluster") + "</h3>\n" + coverage_plot(part, facts);
    }
    if (facts.parts.size() > kMostParts) {
        html +=
            "<p>… and " + std::to_string(facts.parts.size() - kMostParts) + " smaller parts.</p>\n";
    }
    return html;
}

std::string errors(const ReportFacts& facts) {
    return section("Reprojection errors",
                   "How far a feature lies from where the model's point appears in the "
                   "photograph. A good model has most below one pixel and a thin tail.") +
           error_histogram_plot(facts) +
           section("Track lengths",
                   "By how many photographs a point is seen. Points with many observations hold a "
                   "model together; those with two only are weak.") +
           track_length_plot(facts);
}

std::string graph(const ReportFacts& facts) {
    std::map<EdgeState, std::size_t> states;
    for (const EdgeFact& edge : facts.edges) ++states[edge.state];
    HtmlTable table({"pairs", "what became of them"});
    const std::map<EdgeState, std::string> words{
        {EdgeState::kHolds, "hold: both photographs are placed as the pair says"},
        {EdgeState::kOpen, "open: no model says anything of them yet"},
        {EdgeState::kImplausible, "set aside: weak beside what their photographs reach elsewhere"},
        {EdgeState::kApart, "kept apart: their photographs show different places that look alike"},
        {EdgeState::kContradicts, "contradict the model by more than 10°"}};
    for (const auto& [state, count] : states) table.row({std::to_string(count), words.at(state)});
    std::string html = section("View graph",
                               "Pairs of photographs whose matches fit one geometry, darker with "
                               "more matches; red ones were set aside or contradict the model.") +
                       table.finish();
    for (std::size_t i = 0; i < std::min(facts.parts.size(), kMostParts); ++i) {
        if (facts.parts[i].cameras.size() < 2) continue;
        html += "<h3>Part " + std::to_string(facts.parts[i].number) + "</h3>\n" +
                view_graph_plot(facts.parts[i], facts, kMostEdges);
    }
    return html + "<h3>All with all</h3>\n" + match_matrix_plot(facts);
}

std::string positions(const ReportFacts& facts, const ReportOptions& options) {
    std::string html = section("Positions (GPS)",
                               "How far the photographs' own positions are from their cameras in "
                               "the model, along each axis. Phones are off by metres.");
    if (facts.position_errors.empty())
        return html +
               "<p>The model does not stand on the earth: too few photographs have a "
               "position, or they disagree.</p>\n";
    HtmlTable table({"axis", "mean [m]", "sigma [m]", "root of mean square [m]"});
    for (const AxisError& error : facts.position_errors)
        table.row(
            {error.axis, number(error.mean, 2), number(error.sigma, 2), number(error.rms, 2)});
    html += table.finish() + "<p>" + counted(facts.positions, "position") +
            "; nine of ten are within " + number(facts.circular_90_m, 2) +
            " m on the ground.</p>\n";
    if (options.share_location && facts.reference) {
        html += "<p>The frame's origin: " + number(facts.reference->datum.latitude_deg, 6) + ", " +
                number(facts.reference->datum.longitude_deg, 6) + ".</p>\n";
    }
    return html;
}

std::string parameters(const Camera& camera) {
    std::string text(model_name(camera.model));
    for (int i = 0; i < parameter_count(camera.model); ++i)
        text += (i == 0 ? ": " : ", ") + number(camera.params.at(static_cast<std::size_t>(i)), 4);
    return text;
}

const char* source_name(FocalSource source) {
    switch (source) {
        case FocalSource::kUnknown:
            return "guessed";
        case FocalSource::kExif:
            return "EXIF";
        case FocalSource::kGiven:
            return "given";
        case FocalSource::kEstimated:
            return "estimated before";
    }
    return "unknown";
}

std::string cameras(const ReportFacts& facts) {
    // Format: what a page has room for.
    constexpr std::size_t kMostMaps = 12;
    constexpr std::size_t kMostRows = 100;
    std::string html = section(
        "Cameras",
        "Intrinsics before and after: what photographs said, and what each cluster found (focal "
        "length and principal point in pixels, then distortion). Below, where in the photograph "
        "features lie off their points: a pattern means that the camera's model does not fit.");
    std::vector<const CameraFacts*> shown;
    for (const CameraFacts& camera : facts.cameras) {
        if (camera.images > 0) shown.push_back(&camera);
    }
    std::ranges::stable_sort(shown, std::ranges::greater{}, &CameraFacts::images);
    HtmlTable table({"camera", "size", "photographs", "focal length from", "before",
                     "after, by cluster", "mean error [px]"});
    for (std::size_t i = 0; i < std::min(shown.size(), kMostRows); ++i) {
        const CameraFacts& camera = *shown[i];
        std::string after;
        for (std::size_t k = 0; k < std::min<std::size_t>(camera.after.size(), 4); ++k)
            after += (k > 0 ? "; " : "") + parameters(camera.after[k].second);
        if (camera.after.size() > 4)
            after += "; … " + std::to_string(camera.after.size()) + " in all";
        table.row({std::to_string(index_of(camera.id)),
                   std::to_string(camera.before.width) + "×" + std::to_string(camera.before.height),
                   std::to_string(camera.images), source_name(camera.before.focal_source),
                   parameters(camera.before), after, number(camera.mean_px, 3)});
    }
    html += table.finish();
    if (shown.size() > kMostRows)
        html += "<p>… and " + std::to_string(shown.size() - kMostRows) + " more.</p>\n";
    for (std::size_t i = 0; i < std::min(shown.size(), kMostMaps); ++i) {
        html += "<h3>Camera " + std::to_string(index_of(shown[i]->id)) + ": " +
                counted(shown[i]->images, "photograph") + "</h3>\n" + residual_plot(*shown[i]);
    }
    return html;
}

std::string history(const ReportFacts& facts) {
    std::string html = section("What changed when",
                               "The session version by version, and its latest events: clusters "
                               "join and split as photographs come, and a model that contradicts "
                               "its photographs is reset.") +
                       history_plot(facts);
    if (facts.session.summary.events.empty()) return html + "<p>No event so far.</p>\n";
    HtmlTable table({"at image", "event", ""});
    for (const PastEvent& event : facts.session.summary.events)
        table.row({std::to_string(event.image), event.kind, event.text});
    return html + table.finish();
}

std::string times(const ReportOptions& options) {
    std::string html = section("Times and machine",
                               "From the log, where one was given with --log. A node's work is "
                               "the time of all threads at it.");
    if (options.times) {
        const RunTimes& log = *options.times;
        html += "<p>" + counted(log.images, "photograph") + "; from arrival to publication " +
                number(log.median_latency_ms / 1000.0, 2) + " s in the median, 95 % within " +
                number(log.p95_latency_ms / 1000.0, 2) + " s.";
        if (log.seconds > 0.0)
            html += " " + number(log.seconds, 0) + " s in all on " +
                    counted(log.threads, "thread") + ".";
        html += "</p>\n";
        HtmlTable table({"node", "runs", "busy [s]", "waiting [s]", "work [s]"});
        for (const RunTimes::Node& node : log.nodes)
            table.row({node.name, std::to_string(node.runs), number(node.busy_s, 1),
                       number(node.waiting_s, 1), number(node.work_s, 1)});
        if (!log.nodes.empty()) html += table.finish();
    }
    if (options.machine) {
        html += "<p>The report was made on " + escaped(options.machine->processor) + ", " +
                counted(options.machine->cores, "core") + ", " +
                number(options.machine->memory_gib, 1) + " GiB.</p>\n";
    }
    return html;
}

std::string images(const ReportFacts& facts) {
    HtmlTable table({"image", "state", "cluster", "part", "in the model", "error [px]"});
    for (const ImageFact& fact : facts.session.facts) {
        const bool placed = fact.state == ImageState::kPlaced;
        table.row({fact.shown_name(), placed ? "placed" : fact.words,
                   fact.cluster ? std::to_string(index_of(*fact.cluster)) : "",
                   fact.part ? std::to_string(*fact.part) : "",
                   placed ? std::to_string(fact.inliers) : "",
                   placed ? number(fact.error_px, 2) : ""});
    }
    return section("All photographs", "Features in the model, and their mean error.") +
           table.finish();
}

}  // namespace

std::string report_page(const ReportFacts& facts, const ReportOptions& options) {
    const std::string title = "psfm report: " + options.session;
    return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
           "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
           "'unsafe-inline'\">\n"
           "<meta name=\"viewport\" content=\"width=device-width\"><title>" +
           escaped(title) + "</title>\n<style>" + kReportStyle +
           "</style></head><body><main>\n<h1>" + escaped(title) + "</h1>\n" + overview(facts) +
           not_placed(facts) + parts(facts) + errors(facts) + cameras(facts) + graph(facts) +
           positions(facts, options) + history(facts) + times(options) + images(facts) +
           "</main></body></html>\n";
}

}  // namespace psfm
