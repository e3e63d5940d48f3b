// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/contradiction.h"

#include <map>
#include <numbers>

namespace psfm {

Contradiction find_contradiction(const WorkingModel& model, const LocalGraph& graph,
                                 double max_deg) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    std::map<ImageId, std::uint32_t> local;
    for (std::uint32_t image = 0; image < model.image_count(); ++image)
        local[model.image_id(image)] = image;
    Contradiction worst;
    for (const VerifiedPairPtr& pair : graph.pairs) {
        const std::uint32_t i = local.at(pair->pair.first);
        const std::uint32_t j = local.at(pair->pair.second);
        if (!model.registered(i) || !model.registered(j)) continue;
        const Eigen::Quaterniond averaged = graph.rotations[j] * graph.rotations[i].conjugate();
        const Eigen::Quaterniond reconstructed =
            model.pose(j).rotation * model.pose(i).rotation.conjugate();
        const double angle_deg = kDegrees * averaged.angularDistance(reconstructed);
        ++worst.edges;
        if (angle_deg > max_deg) ++worst.beyond;
        if (angle_deg > worst.angle_deg) {
            worst.angle_deg = angle_deg;
            worst.pair = pair->pair;
        }
    }
    return worst;
}

}  // namespace psfm
