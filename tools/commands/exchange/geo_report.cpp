// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/geo_report.h"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace psfm {
namespace {

// Format: digits after the point: a millimetre on the ground.
constexpr int kDegreeDigits = 8;
constexpr int kMetreDigits = 3;
// Format: … and about a metre, for people.
constexpr int kShortDegreeDigits = 5;

}  // namespace

std::optional<WorldReference> world_reference_of(std::span<const ExportedModel> models,
                                                 std::span<const Image> images) {
    std::vector<std::vector<CameraCentre>> cameras;
    for (const ExportedModel& model : models) {
        std::vector<CameraCentre>& centres = cameras.emplace_back();
        for (const ExportedImage& image : model.images) {
            centres.push_back({static_cast<ImageId>(image.id - 1),
                               image.cam_from_world.target_origin_in_source()});
        }
    }
    return world_reference(cameras, evidence_of(images));
}

std::string describe(const WorldReference& reference) {
    const GeoreferenceOptions options;
    const auto placed = std::ranges::count_if(
        reference.models, [&](const auto& model) { return model.is_enough(options); });
    double worst = 0.0;
    for (const PositionAgreement& model : reference.models) {
        if (model.is_enough(options)) worst = std::max(worst, model.median_m);
    }
    std::ostringstream text;
    text << std::fixed << std::setprecision(kShortDegreeDigits) << "geo-referenced about "
         << reference.datum.latitude_deg << ", " << reference.datum.longitude_deg << ": " << placed
         << " of " << reference.models.size()
         << " connected parts by their photographs' positions, which are " << std::setprecision(1)
         << worst << " m off in the median" << (placed > 1 ? " of the worst part" : "");
    return text.str();
}

std::string geo_text(const WorldReference& reference) {
    const GeoreferenceOptions options;
    std::ostringstream text;
    text << std::fixed << std::setprecision(kDegreeDigits)
         << "# Where the models beside this file stand on the earth.\n"
            "# Their unit is the metre; x is east, y is north, z is up, in the frame that touches "
            "the WGS 84\n"
            "# ellipsoid above this point. Altitudes are those of the photographs' files.\n"
         << "datum_latitude_deg " << reference.datum.latitude_deg << "\ndatum_longitude_deg "
         << reference.datum.longitude_deg << "\ndatum_altitude_m "
         << std::setprecision(kMetreDigits) << reference.datum.altitude_m.value_or(0.0)
         << "\n# Each model: photographs with a position, and how far off these are, east-north. A "
            "model that is not\n"
            "# `placed` has too little evidence: its place, heading and scale may be arbitrary.\n";
    for (std::size_t k = 0; k < reference.models.size(); ++k) {
        const PositionAgreement& model = reference.models[k];
        text << "model " << k << (model.is_enough(options) ? " placed" : " unplaced")
             << " positions " << model.positions << " agreeing " << model.inliers << " median_m "
             << model.median_m << " max_m " << model.max_m << '\n';
    }
    return text.str();
}

}  // namespace psfm
