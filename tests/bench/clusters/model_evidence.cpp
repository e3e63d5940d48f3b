// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// model_evidence SESSION [REFERENCE [POINTS_PER_IMAGE]]
//
// What the models of a session say of their being right, a row each of the tables in
// docs/look-alikes.md: of matched pairs with 40 points and more that are seen from both sides
// (seen_between.h), which part is shared; the least over the cuts of the model (model_cuts.h); and
// regions that are missing (missing_regions.h). Beside a reference (a COLMAP model) the pairs that
// stand wrongly have a row of their own.
#include <algorithm>
#include <iomanip>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "stages/algorithms/math/angles.h"
#include "stages/reconstruction/checks/model_cuts.h"
#include "storage/exchange/models/read_colmap.h"
#include "tests/bench/clusters/session_cluster.h"

namespace psfm::bench {
namespace {

constexpr std::uint32_t kLeastExpected = 40;

double quantile(std::vector<double> values, double part) {
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
}

/// Which pairs of a model stand wrongly: they are turned by more than 10 degrees, or shifted by
/// more than three spacings and a fifth of their distance.
class Truth {
  public:
    Truth(const Reconstruction& model, const std::vector<Image>& images,
          const std::map<std::string, Rigid3>& known) {
        for (const RegisteredImage& image : model.images) {
            const auto found = known.find(images[index_of(image.image)].name);
            poses_.push_back({image.cam_from_cluster,
                              found == known.end() ? Rigid3{} : found->second,
                              found != known.end()});
        }
        measure();
    }

    bool is_wrong(std::uint32_t i, std::uint32_t j) const {
        if (spacing_ == 0.0 || !poses_[i].is_known || !poses_[j].is_known) return false;
        const Rigid3 model = poses_[j].model * inverse(poses_[i].model);
        const Rigid3 truth = poses_[j].truth * inverse(poses_[i].truth);
        const double turn = kDegreesPerRadian * model.rotation.angularDistance(truth.rotation);
        const double off = (scale_ * model.translation - truth.translation).norm();
        return turn > 10.0 || off > std::max(0.2 * truth.translation.norm(), 3.0 * spacing_);
    }

  private:
    struct Pose {
        Rigid3 model;
        Rigid3 truth;
        bool is_known = false;
    };

    /// Scale and spacing, by each image's nearest one.
    void measure() {
        std::vector<double> scales;
        std::vector<double> spacings;
        for (const Pose& one : poses_) {
            double spacing = 0.0;
            double scale = 1.0;
            for (const Pose& other : poses_) {
                if (&one == &other || !one.is_known || !other.is_known) continue;
                const double distance = distance_of(one.truth, other.truth);
                if (spacing > 0.0 && distance >= spacing) continue;
                spacing = distance;
                scale = distance / std::max(1e-12, distance_of(one.model, other.model));
            }
            if (spacing == 0.0) continue;
            scales.push_back(scale);
            spacings.push_back(spacing);
        }
        if (scales.empty()) return;
        scale_ = quantile(scales, 0.5);
        spacing_ = quantile(spacings, 0.5);
    }
    static double distance_of(const Rigid3& one, const Rigid3& other) {
        return (one.target_origin_in_source() - other.target_origin_in_source()).norm();
    }

    std::vector<Pose> poses_;
    double scale_ = 1.0;
    double spacing_ = 0.0;
};

void show_pairs(const char* kind, const std::vector<double>& parts) {
    if (parts.empty()) return;
    std::cout << "  " << kind << " pairs: " << parts.size() << ", shared (0, 1, 5, 25, 50 %)";
    for (const double part : {0.0, 0.01, 0.05, 0.25, 0.5})
        std::cout << ' ' << std::fixed << std::setprecision(2) << quantile(parts, part);
    std::cout << '\n';
}

void show(const Reconstruction& model, const Truth& truth, const ClusterProblem& problem,
          std::uint32_t points) {
    const SolveOptions options;
    Judged judged;
    judged.attempt.model = model;
    judged.edges = edges_of(model, problem, {}, options.doubt);
    judged.between =
        matched_between(find_seen_between(model, options.places.between, points), judged.edges);
    std::vector<double> right;
    std::vector<double> wrong;
    for (const SeenBetween& pair : judged.between) {
        if (pair.expected < kLeastExpected) continue;
        (truth.is_wrong(pair.first, pair.second) ? wrong : right).push_back(pair.shared_part());
    }
    std::cout << model.images.size() << " images, " << model.points.size() << " points\n";
    show_pairs("right", right);
    show_pairs("wrong", wrong);
    if (!options.policy.may_be_doubted(model.images.size())) return;
    double least = 1.0;
    for (const Cut& cut : cuts_of(judged, options.doubt)) {
        if (std::min(cut.expected, cut.expected_elsewhere) >= options.doubt.min_between)
            least = std::min(least, cut.shared_part());
    }
    std::uint32_t regions = 0;
    std::uint32_t missing = 0;
    std::uint32_t contradicting = 0;
    for (const ComparedPair& pair : compare_by_region(model, options.doubt)) {
        regions += pair.regions;
        missing += pair.missing;
        contradicting += contradicts(pair, options.doubt) ? 1 : 0;
    }
    std::cout << "  least across a cut " << least << "; " << missing << " of " << regions
              << " regions missing, " << contradicting << " pairs contradict\n";
}

void run(const std::string& folder, const std::string& reference, std::uint32_t points) {
    const auto session = need(open_session_reader(folder, {}));
    const auto images = need(session->images());
    std::map<std::string, Rigid3> known;
    if (!reference.empty()) {
        for (const ExportedImage& image :
             need(read_colmap_model(reference, {.cameras = false, .keypoints = false})).images)
            known[image.name] = image.cam_from_world;
    }
    const ClusterProblem problem = cluster_of_session(*session, 1);
    for (const auto& cluster : need(session->scene()).clusters) {
        if (cluster->model && cluster->model->images.size() >= 5)
            show(*cluster->model, Truth(*cluster->model, images, known), problem, points);
    }
}

}  // namespace
}  // namespace psfm::bench

int main(int argc, char** argv) {
    if (argc < 2 || argc > 4) {
        std::cerr << "usage: model_evidence SESSION [REFERENCE [POINTS_PER_IMAGE]]\n";
        return 2;
    }
    psfm::bench::run(argv[1], argc > 2 ? argv[2] : "",
                     argc > 3 ? static_cast<std::uint32_t>(std::stoul(argv[3])) : 0);
    return 0;
}
