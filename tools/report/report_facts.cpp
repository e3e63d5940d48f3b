// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/report_facts.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tools/report/residuals.h"
#include "tools/report/up_direction.h"

namespace psfm {
namespace {

double quantile(std::vector<double> values, double part) {
    if (values.empty()) return 0.0;
    std::ranges::sort(values);
    const double place = part * static_cast<double>(values.size() - 1);
    return values[static_cast<std::size_t>(std::lround(place))];
}

Eigen::Vector3d centre_of(const SceneCluster& cluster, const RegisteredImage& image) {
    return cluster.world_from_cluster * image.cam_from_cluster.target_origin_in_source();
}

/// Two directions of the ground: across the mean of which way the photographs were up.
Eigen::Matrix<double, 2, 3> ground_of(const std::vector<const SceneCluster*>& clusters,
                                      const std::vector<Image>& images, bool is_enu) {
    const Eigen::Vector3d up =
        is_enu ? Eigen::Vector3d::UnitZ().eval() : up_direction(clusters, images);
    const Eigen::Vector3d hint =
        std::abs(up.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
    const Eigen::Vector3d right = (hint - hint.dot(up) * up).normalized();
    Eigen::Matrix<double, 2, 3> ground;
    ground.row(0) = right.transpose();
    ground.row(1) = up.cross(right).transpose();
    return ground;
}

/// Leaves out the outermost per cent on every side: a few far points would make a dot of the rest.
std::vector<Eigen::Vector2d> without_outermost(std::vector<Eigen::Vector2d> points) {
    std::vector<double> x, y;
    for (const Eigen::Vector2d& point : points) {
        x.push_back(point.x());
        y.push_back(point.y());
    }
    const double x0 = quantile(x, 0.01), x1 = quantile(x, 0.99);
    const double y0 = quantile(y, 0.01), y1 = quantile(y, 0.99);
    std::erase_if(points, [&](const Eigen::Vector2d& point) {
        return point.x() < x0 || point.x() > x1 || point.y() < y0 || point.y() > y1;
    });
    return points;
}

void add_parts(ReportFacts& facts) {
    std::map<std::uint32_t, std::vector<const SceneCluster*>> by_part;
    for (const auto& cluster : facts.session.scene.clusters) {
        if (cluster->model && !cluster->model->empty())
            by_part[cluster->effective_cluster].push_back(cluster.get());
    }
    std::size_t position = 0;
    for (const auto& [number, clusters] : by_part) {
        PartFacts part;
        part.number = number;
        part.clusters = clusters.size();
        const std::size_t k = position++;
        part.in_metres = facts.reference && k < facts.reference->models.size() &&
                         facts.reference->models[k].is_enough(GeoreferenceOptions{});
        const auto ground = ground_of(clusters, facts.session.images, part.in_metres);
        for (const SceneCluster* cluster : clusters) {
            part.points += cluster->model->points.size();
            for (const RegisteredImage& image : cluster->model->images)
                part.cameras.emplace_back(image.image, ground * centre_of(*cluster, image));
            for (const ScenePoint& point : cluster->model->points)
                part.points_above.push_back(ground *
                                            (cluster->world_from_cluster * point.position));
        }
        part.points_above = without_outermost(std::move(part.points_above));
        facts.parts.push_back(std::move(part));
    }
    std::ranges::stable_sort(facts.parts, std::ranges::greater{},
                             [](const PartFacts& part) { return part.cameras.size(); });
}

void add_residual(const Residual& residual, const Camera& camera, CameraFacts& facts) {
    const auto cell_of = [](double place, std::uint32_t size, int cells) {
        return std::clamp(static_cast<int>(place / size * cells), 0, cells - 1);
    };
    const int column = cell_of(residual.observed_px.x(), camera.width, CameraFacts::kColumns);
    const int row = cell_of(residual.observed_px.y(), camera.height, CameraFacts::kRows);
    ResidualCell& cell = facts.cells.at(static_cast<std::size_t>(row) * CameraFacts::kColumns +
                                        static_cast<std::size_t>(column));
    ++cell.count;
    cell.mean_px += residual.difference_px;
    cell.mean_length_px += residual.difference_px.norm();
}

void finish(CameraFacts& camera) {
    double sum = 0.0;
    std::size_t count = 0;
    for (ResidualCell& cell : camera.cells) {
        if (cell.count == 0) continue;
        sum += cell.mean_length_px;
        count += cell.count;
        cell.mean_px /= cell.count;
        cell.mean_length_px /= cell.count;
    }
    if (count > 0) camera.mean_px = sum / static_cast<double>(count);
}

Result<void> add_residuals(const SessionReader& session, ReportFacts& facts) {
    const auto accepted = session.cameras();
    if (!accepted.ok()) return accepted.error();
    std::map<CameraId, CameraFacts> cameras;
    for (const auto& [id, camera] : *accepted) {
        cameras[id].id = id;
        cameras[id].before = camera;
    }
    facts.error_histogram.assign(ReportFacts::kErrorBins, 0);
    double sum = 0.0, squares = 0.0;
    for (const auto& cluster : facts.session.scene.clusters) {
        if (!cluster->model) continue;
        const Reconstruction& model = *cluster->model;
        facts.points += model.points.size();
        for (const ScenePoint& point : model.points)
            ++facts.track_lengths[static_cast<std::uint32_t>(point.track.size())];
        const auto residuals =
            residuals_of(model, [&](ImageId image) { return session.keypoints(image); });
        if (!residuals.ok()) return residuals.error();
        for (const auto& [id, camera] : model.cameras)
            cameras[id].after.emplace_back(cluster->id, camera);
        for (std::size_t i = 0; i < residuals->size(); ++i) {
            CameraFacts& camera = cameras[model.images[i].camera];
            ++camera.images;
            for (const Residual& residual : (*residuals)[i]) {
                const double length = residual.difference_px.norm();
                sum += length;
                squares += length * length;
                ++facts.observations;
                const auto bin = static_cast<std::size_t>(length / ReportFacts::kErrorStepPx);
                ++facts.error_histogram[std::min(bin, ReportFacts::kErrorBins - 1)];
                add_residual(residual, model.cameras.at(model.images[i].camera), camera);
            }
        }
    }
    for (auto& [id, camera] : cameras) {
        finish(camera);
        facts.cameras.push_back(std::move(camera));
    }
    if (facts.observations > 0) {
        const auto count = static_cast<double>(facts.observations);
        facts.mean_error_px = sum / count;
        facts.rms_error_px = std::sqrt(squares / count);
    }
    if (facts.points > 0) {
        facts.mean_track =
            static_cast<double>(facts.observations) / static_cast<double>(facts.points);
    }
    return {};
}

/// East, north and up, of positions against the cameras of parts that stand on the earth.
void add_position_errors(ReportFacts& facts) {
    if (!facts.reference) return;
    const GpsPosition& datum = facts.reference->datum;
    std::array<std::vector<double>, 3> errors;
    std::vector<double> horizontal;
    std::size_t position = 0;
    std::map<std::uint32_t, std::size_t> model_of_part;
    for (const auto& cluster : facts.session.scene.clusters) {
        if (cluster->model && !cluster->model->empty())
            model_of_part.try_emplace(cluster->effective_cluster, 0);
    }
    for (auto& [part, model] : model_of_part) model = position++;
    for (const auto& cluster : facts.session.scene.clusters) {
        if (!cluster->model) continue;
        if (cluster->model->empty()) continue;
        const std::size_t model = model_of_part.at(cluster->effective_cluster);
        if (model >= facts.reference->models.size() ||
            !facts.reference->models[model].is_enough(GeoreferenceOptions{})) {
            continue;
        }
        for (const RegisteredImage& image : cluster->model->images) {
            const auto& gps = facts.session.images[index_of(image.image)].metadata.gps;
            if (!gps || !is_plausible(*gps)) continue;
            const Eigen::Vector3d off = centre_of(*cluster, image) - enu_from_wgs84(datum, *gps);
            for (int axis = 0; axis < 3; ++axis) {
                if (axis < 2 || gps->altitude_m) errors.at(axis).push_back(off[axis]);
            }
            horizontal.push_back(off.head<2>().norm());
        }
    }
    facts.positions = horizontal.size();
    facts.circular_90_m = quantile(horizontal, 0.9);
    const std::array<const char*, 3> names{"east", "north", "up"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (errors.at(axis).empty()) continue;
        const auto count = static_cast<double>(errors.at(axis).size());
        AxisError error;
        error.axis = names.at(axis);
        double squares = 0.0;
        for (const double value : errors.at(axis)) {
            error.mean += value / count;
            squares += value * value / count;
        }
        error.rms = std::sqrt(squares);
        error.sigma = std::sqrt(std::max(0.0, squares - error.mean * error.mean));
        facts.position_errors.push_back(error);
    }
}

}  // namespace

Spread spread_of(std::vector<double> values) {
    Spread spread;
    spread.count = values.size();
    if (values.empty()) return spread;
    const auto [least, largest] = std::ranges::minmax(values);
    spread.least = least;
    spread.largest = largest;
    spread.mean =
        std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    spread.median = quantile(std::move(values), 0.5);
    return spread;
}

Result<ReportFacts> read_report_facts(const SessionReader& session,
                                      const std::optional<WorldReference>& reference,
                                      SessionFacts session_facts) {
    ReportFacts facts;
    facts.session = std::move(session_facts);
    facts.reference = reference;
    auto edges = read_edges(session, facts.session.scene);
    if (!edges.ok()) return edges.error();
    facts.edges = *std::move(edges);
    if (const auto added = add_residuals(session, facts); !added.ok()) return added.error();
    add_parts(facts);
    add_position_errors(facts);
    std::vector<double> features, inliers;
    for (const ImageFact& fact : facts.session.facts) {
        if (!fact.id) continue;
        const auto keypoints = session.keypoints(*fact.id);
        if (!keypoints.ok()) return keypoints.error();
        features.push_back(static_cast<double>((*keypoints)->size()));
        if (fact.state == ImageState::kPlaced) inliers.push_back(fact.inliers);
    }
    facts.features = spread_of(std::move(features));
    facts.inliers = spread_of(std::move(inliers));
    return facts;
}

}  // namespace psfm
