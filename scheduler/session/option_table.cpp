// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/option_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

namespace psfm {
namespace {

constexpr double kCount = 4294967295.0;  ///< the largest of 32 bits

template <typename T>
void assign(T& field, double value) {
    field = static_cast<T>(value);
}

// A macro, so that a name cannot differ from the field that it stands for, unless the field has
// moved since the name was released.
#define PSFM_OPTION(FIELD, LOW, HIGH, WHAT) PSFM_MOVED_OPTION(#FIELD, FIELD, LOW, HIGH, WHAT)
#define PSFM_MOVED_OPTION(NAME, FIELD, LOW, HIGH, WHAT)                                     \
    NamedOption {                                                                           \
        NAME, WHAT, LOW, HIGH,                                                              \
            [](const StageOptions& options) { return static_cast<double>(options.FIELD); }, \
            [](StageOptions& options, double value) { assign(options.FIELD, value); }       \
    }

// clang-format off
constexpr std::array kTable{
    PSFM_OPTION(clustering.eta, 0, 1, "distance below which two images are in one cluster"),
    PSFM_OPTION(clustering.hold_from, 2, kCount, "clusters of fewer images join one of any size"),
    PSFM_OPTION(clustering.join_below, 0, 1000, "images that a group needs to stay by itself; 0: any does"),
    PSFM_OPTION(clustering.join_up_to, 0, kCount, "images up to which large clusters join while images stream in; 0: always"),
    PSFM_OPTION(edges.min_inliers, 1, kCount, "verified inliers that an edge of the view graph needs"),
    PSFM_OPTION(edges.min_relative_plausibility, 0, 1, "part of the best plausibility of its images that an edge needs"),
    PSFM_OPTION(edges.min_weak_inliers, 0, kCount, "verified inliers that a weak edge needs; 0: there are none"),
    PSFM_OPTION(edges.still.min_pairs, 0, kCount, "pairs that show a feature stand still before it counts for no scene; 0: it always does"),
    PSFM_OPTION(features.sift.contrast_threshold, 1e-4, 1, "least contrast of a feature"),
    PSFM_OPTION(features.sift.edge_threshold, 1.01, 1000, "largest ratio of a feature's principal curvatures"),
    PSFM_OPTION(features.sift.max_features, 1, 1e6, "most places of a photograph that have features"),
    PSFM_OPTION(features.sift.max_image_size, 64, 30000, "longer side to which photographs are reduced for detection [px]"),
    PSFM_OPTION(features.sift.max_orientations, 1, 36, "most orientations of a place, a feature each"),
    PSFM_OPTION(retrieval.candidates, 1, kCount, "candidates of an image among earlier ones"),
    PSFM_OPTION(retrieval.features_per_image, 1, kCount, "features of an image that are indexed and looked up"),
    PSFM_OPTION(solve.absolute_pose.max_error_px, 0.01, 1000, "reprojection error of an inlier of a registration [px]"),
    PSFM_OPTION(solve.absolute_pose.max_iterations, 1, 1e8, "RANSAC iterations of a registration"),
    PSFM_OPTION(solve.absolute_pose.min_inlier_ratio, 0, 1, "share of the points that a registration needs"),
    PSFM_OPTION(solve.absolute_pose.min_inliers, 4, kCount, "inliers that a registration needs"),
    PSFM_OPTION(solve.assessment.max_invented, 0, 1, "part of known turns that a model may show as steps; 0: all"),
    PSFM_OPTION(solve.doubt.max_cuts, 0, 1000, "cuts of a doubted model that are tried"),
    PSFM_MOVED_OPTION("solve.doubt.max_images", solve.policy.doubt_up_to, 0, 2000, "images up to which a model is compared with others at the end; 0: none is"),
    PSFM_OPTION(solve.doubt.min_missing_part, 0.01, 1, "part of a pair's regions that are missing where it contradicts its model"),
    PSFM_MOVED_OPTION("solve.eta_grow", solve.policy.full_adjustment.again_when_grown_by, 0, 100, "growth after which all of a model is adjusted"),
    PSFM_OPTION(solve.few_points.min_points, 0, kCount, "points that an image needs which no model sees enough of; 0: as any"),
    PSFM_OPTION(solve.initialization.max_pairs, 1, kCount, "pairs tried for one start"),
    PSFM_OPTION(solve.initialization.min_angle_deg, 0, 180, "median triangulation angle of a start [deg]"),
    PSFM_OPTION(solve.initialization.min_points, 5, kCount, "points of a start"),
    PSFM_OPTION(solve.max_contradiction_deg, 0, 180, "rotations that differ by more contradict a model [deg]"),
    PSFM_OPTION(solve.max_edge_error_deg, 0, 180, "edges that differ by more from averaged rotations are left out [deg]"),
    PSFM_OPTION(solve.min_observations, 1, kCount, "observations that keep an image in its model"),
    PSFM_MOVED_OPTION("solve.mu_max", solve.policy.mu_max, 2, kCount, "images up to which a new cluster is started incrementally"),
    PSFM_MOVED_OPTION("solve.mu_min", solve.policy.mu_min, 2, kCount, "images that a cluster needs to be reconstructed"),
    PSFM_OPTION(solve.settling.noise.loss, 0, 1000, "width of the settling adjustment's loss, in noises of the model; 0: 1 px"),
    PSFM_OPTION(solve.settling.noise.max_error, 0, 1000, "error of an observation that settling keeps, in noises of the model; 0: as while growing"),
    PSFM_OPTION(solve.tracks.max_error_px, 0.01, 1000, "largest reprojection error of an observation [px]"),
    PSFM_OPTION(solve.tracks.min_angle_deg, 0, 180, "least triangulation angle of a point [deg]"),
    PSFM_OPTION(verification.cells.max_excess, 0, 4, "how much farther cells of descriptors are looked into"),
    PSFM_OPTION(verification.cells.min_strongest_matches, 0, kCount, "matches of the strongest features that a pair needs"),
    PSFM_OPTION(verification.cells.strongest_rows, 1, kCount, "features of largest scale that are compared first"),
    PSFM_OPTION(verification.enough_pairs, 0, kCount, "verified pairs after which ranked candidates are not tried any more; 0: all"),
    PSFM_OPTION(verification.match.max_distance, 0, 2, "largest distance of two matching descriptors"),
    PSFM_OPTION(verification.match.max_ratio, 0, 1, "nearest over second nearest distance of a match"),
    PSFM_OPTION(verification.verify.homography_ratio, 0, 1, "share of the inliers with which a homography explains a pair"),
    PSFM_OPTION(verification.verify.max_error_px, 0.01, 1000, "epipolar error of an inlier [px]"),
    PSFM_OPTION(verification.verify.max_iterations, 1, 1e8, "RANSAC iterations of a pair"),
    PSFM_OPTION(verification.verify.max_uncalibrated_error_px, 0.01, 1000, "the same where a focal length is unknown [px]"),
    PSFM_OPTION(verification.verify.min_inlier_ratio, 0, 1, "share of the matches that a verified pair needs"),
    PSFM_OPTION(verification.verify.min_inliers, 8, kCount, "inliers that a verified pair needs"),
    PSFM_OPTION(verification.verify.still.min_matches, 0, kCount, "matches at one place of both photographs that are looked at twice; 0: none are"),
};
// clang-format on
#undef PSFM_OPTION
#undef PSFM_MOVED_OPTION

static_assert(std::ranges::is_sorted(kTable, {}, &NamedOption::name));

const NamedOption* find(std::string_view name) {
    const auto* found = std::ranges::lower_bound(kTable, name, {}, &NamedOption::name);
    return found != kTable.end() && found->name == name ? found : nullptr;
}

/// Names that end as the asked one does, to show what may have been meant.
std::string alike(std::string_view name) {
    const std::string_view field = name.substr(name.rfind('.') + 1);
    std::string names;
    for (const NamedOption& option : kTable) {
        if (option.name.find(field) == std::string_view::npos) continue;
        names += (names.empty() ? "" : ", ") + std::string(option.name);
    }
    return names;
}

Error unknown(const std::string& name) {
    const std::string names = alike(name);
    return {ErrorCode::kInvalidArgument,
            "there is no option '" + name + "'" +
                (names.empty() ? "; `psfm options` lists them" : "; did you mean " + names + "?")};
}

std::string text(double value) {
    char buffer[32];
    const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
    return {buffer, end};
}

}  // namespace

std::span<const NamedOption> option_table() {
    return kTable;
}

std::map<std::string, double> option_values(const StageOptions& options) {
    std::map<std::string, double> values;
    for (const NamedOption& option : kTable) values.emplace(option.name, option.get(options));
    return values;
}

Result<void> set_options(StageOptions& options, const std::map<std::string, double>& values) {
    for (const auto& [name, value] : values) {
        const NamedOption* option = find(name);
        if (option == nullptr) return unknown(name);
        if (!(value >= option->low && value <= option->high)) {
            return Error{ErrorCode::kInvalidArgument,
                         name + " is " + text(value) + "; give a value from " + text(option->low) +
                             " to " + text(option->high)};
        }
        option->set(options, value);
    }
    return {};
}

Result<std::pair<std::string, double>> parse_setting(const std::string& text) {
    const std::size_t sign = text.find('=');
    const std::string name = text.substr(0, sign);
    if (sign == std::string::npos)
        return Error{ErrorCode::kInvalidArgument, "'" + text + "' is not of the form NAME=VALUE"};
    if (find(name) == nullptr) return unknown(name);
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto [parsed, error] = std::from_chars(text.data() + sign + 1, end, value);
    if (error != std::errc{} || parsed != end)
        return Error{ErrorCode::kInvalidArgument,
                     name + " wants a number, not '" + text.substr(sign + 1) + "'"};
    return std::pair(name, value);
}

}  // namespace psfm
