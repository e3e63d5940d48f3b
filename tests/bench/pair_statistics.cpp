// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The verified pairs of a session, one a line: what edges of the view graph are chosen by, and,
// with known poses, how far each pair's relative rotation is from the truth.
//   pair_statistics SESSION [REFERENCE]     REFERENCE: a COLMAP model with known poses
#include <cstdio>
#include <iostream>
#include <map>
#include <numbers>
#include <string>

#include "stages/clustering/jaccard_distance.h"
#include "stages/clustering/plausibility.h"
#include "storage/exchange/models/read_colmap.h"
#include "storage/session/session_store.h"

namespace psfm::bench {
namespace {

std::map<std::string, Rigid3> poses_of(const ExportedModel& model) {
    std::map<std::string, Rigid3> poses;
    for (const ExportedImage& image : model.images) poses.emplace(image.name, image.cam_from_world);
    return poses;
}

double degrees_off(const Rigid3& cam2_from_cam1, const Rigid3& cam1, const Rigid3& cam2) {
    const Eigen::Quaterniond truth = cam2.rotation * cam1.rotation.conjugate();
    return truth.angularDistance(cam2_from_cam1.rotation) * 180.0 / std::numbers::pi;
}

int print_pairs(const std::string& session, const std::string& reference) {
    const auto reader = open_session_reader(session, StoreOptions{});
    if (!reader.ok()) return std::cerr << reader.error().message << '\n', 1;
    const auto images = (*reader)->images();
    if (!images.ok()) return std::cerr << images.error().message << '\n', 1;
    std::map<std::string, Rigid3> truth;
    if (!reference.empty()) {
        const auto model = read_colmap_model(reference);
        if (!model.ok()) return std::cerr << model.error().message << '\n', 1;
        truth = poses_of(*model);
    }
    std::vector<VerifiedPairPtr> pairs;
    for (const Image& image : *images) {
        const auto found = (*reader)->pairs_of(image.id);
        if (!found.ok()) return std::cerr << found.error().message << '\n', 1;
        pairs.insert(pairs.end(), found->begin(), found->end());
    }
    const ViewGraph graph(pairs);
    std::cout
        << "first\tsecond\tkind\tinliers\tangle\tdensity\tcore\tplausibility\tdistance\toff\n";
    for (const VerifiedPairPtr& pair : pairs) {
        const TwoViewGeometry& geometry = pair->geometry;
        const auto [first, second] = pair->pair;
        const std::string& name1 = (*images)[index_of(first)].name;
        const std::string& name2 = (*images)[index_of(second)].name;
        const double distance = jaccard_sums(graph, first, second, JaccardForm::kMutual).distance();
        double off = -1.0;
        if (truth.contains(name1) && truth.contains(name2))
            off = degrees_off(geometry.cam2_from_cam1, truth.at(name1), truth.at(name2));
        std::printf("%s\t%s\t%d\t%zu\t%.1f\t%.3f\t%.3f\t%.2f\t%.2f\t%.1f\n", name1.c_str(),
                    name2.c_str(), static_cast<int>(geometry.kind), geometry.inliers.size(),
                    geometry.median_angle_deg, geometry.match_density, geometry.core_density,
                    plausibility(geometry, PlausibilityOptions{}), distance, off);
    }
    return 0;
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        std::cerr << "usage: pair_statistics SESSION [REFERENCE]\n";
        return 2;
    }
    return psfm::bench::print_pairs(argv[1], argc > 2 ? argv[2] : "");
}
