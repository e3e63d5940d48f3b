// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graph/result.h"
#include "stages/merge/geo/world_reference.h"
#include "tools/report/edge_facts.h"
#include "tools/report/image_facts.h"

namespace psfm {

/// Of some numbers: their least, largest, mean and median; 0 of none.
struct Spread {
    std::size_t count = 0;
    double least = 0.0, largest = 0.0, mean = 0.0, median = 0.0;
};
Spread spread_of(std::vector<double> values);

/// One part that stands alone, from above: x and y span the ground, which is across the mean up
/// direction of its photographs.
struct PartFacts {
    std::uint32_t number = 0;
    std::size_t clusters = 0, points = 0;
    bool in_metres = false;  ///< it is geo-referenced
    std::vector<std::pair<ImageId, Eigen::Vector2d>> cameras;
    std::vector<Eigen::Vector2d> points_above;  ///< without the outermost per cent
};

/// Mean residual of a cell of the photograph.
struct ResidualCell {
    std::uint32_t count = 0;
    Eigen::Vector2d mean_px = Eigen::Vector2d::Zero();
    double mean_length_px = 0.0;
};

/// One physical camera, as its photographs said and as clusters have found it.
struct CameraFacts {
    static constexpr int kColumns = 12, kRows = 9;  // Format: cells of a map of residuals
    CameraId id{};
    Camera before;
    std::vector<std::pair<ClusterId, Camera>> after;
    std::size_t images = 0;  ///< placed
    std::array<ResidualCell, kColumns * kRows> cells{};
    double mean_px = 0.0;  ///< mean length of its residuals
};

/// Positions of photographs against the model, of one axis [m].
struct AxisError {
    std::string axis;
    double mean = 0.0, sigma = 0.0, rms = 0.0;
};

/// All that the report tells, counted once.
struct ReportFacts {
    SessionFacts session;
    std::vector<EdgeFact> edges;
    std::vector<PartFacts> parts;      ///< most images first
    std::vector<CameraFacts> cameras;  ///< by id
    std::size_t points = 0, observations = 0;
    double mean_track = 0.0;
    double mean_error_px = 0.0, rms_error_px = 0.0;
    std::vector<std::size_t> error_histogram;  ///< kErrorStepPx wide, the rest in the last
    std::map<std::uint32_t, std::size_t> track_lengths;  ///< images of a point: points
    Spread features, inliers;                            ///< an image; inliers of placed ones
    std::optional<WorldReference> reference;
    std::vector<AxisError> position_errors;  ///< east, north, up; empty without positions
    double circular_90_m = 0.0;              ///< 90 % of the positions are no farther off
    std::size_t positions = 0;

    static constexpr double kErrorStepPx = 0.1;    // Format: of the histogram
    static constexpr std::size_t kErrorBins = 40;  // Format: of the histogram
};

/// @param reference  where on the earth the version stands, if anywhere
/// @errors those of the store
Result<ReportFacts> read_report_facts(const SessionReader& session,
                                      const std::optional<WorldReference>& reference,
                                      SessionFacts facts);

}  // namespace psfm
