// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/report_plots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/report/svg.h"

namespace psfm {
namespace {

/// Format: plots on the page [px].
constexpr double kWide = 640.0;
constexpr double kMostHigh = 480.0;
constexpr int kLevels = 5;  // of grey, as classes l0 … l4

std::string class_of_level(int level) {
    // append: GCC 12 takes "l" + string for an overlapping copy here (GCC bug 105329).
    return std::string("l").append(std::to_string(level));
}

std::string level_class(double share) {
    return class_of_level(std::clamp(static_cast<int>(share * kLevels), 0, kLevels - 1));
}

/// From the ground to the plot; y goes up there and down here.
struct GroundFrame {
    Eigen::Vector2d lowest{0.0, 0.0};
    double scale = 1.0;
    double height = kMostHigh;

    static GroundFrame of(const PartFacts& part) {
        Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
        Eigen::Vector2d high = -low;
        const auto add = [&](const Eigen::Vector2d& point) {
            low = low.cwiseMin(point);
            high = high.cwiseMax(point);
        };
        for (const auto& [image, place] : part.cameras) add(place);
        for (const Eigen::Vector2d& point : part.points_above) add(point);
        const Eigen::Vector2d extent = (high - low).cwiseMax(1e-9);
        GroundFrame frame;
        frame.scale = std::min((kWide - 20) / extent.x(), (kMostHigh - 20) / extent.y());
        frame.lowest = low;
        frame.height = extent.y() * frame.scale + 20;
        return frame;
    }
    Eigen::Vector2d operator()(const Eigen::Vector2d& place) const {
        const Eigen::Vector2d scaled = (place - lowest) * scale;
        return {10 + scaled.x(), height - 10 - scaled.y()};
    }
};

/// A bar whose length is a round number of metres.
void scale_bar(Svg& svg, const GroundFrame& frame, bool in_metres) {
    const double length = round_step(150.0 * 5.0 / frame.scale);
    const double y = frame.height - 6;
    svg.line(10, y, 10 + length * frame.scale, y, "scale");
    svg.text(14 + length * frame.scale, y + 2,
             short_number(length, 6) + (in_metres ? " m" : " units of the model"));
}

std::string square(double x, double y, double side) {
    return 'M' + short_number(x, 1) + ' ' + short_number(y, 1) + 'h' + short_number(side, 1) + 'v' +
           short_number(side, 1) + 'h' + short_number(-side, 1) + 'z';
}

}  // namespace

std::string coverage_plot(const PartFacts& part, const ReportFacts& facts) {
    const GroundFrame frame = GroundFrame::of(part);
    Svg svg(kWide, frame.height + 10,
            "Points from above, darker where there are more, and cameras");
    constexpr double kCell = 6.0;  // Format: side of a square of points [px]
    std::map<std::pair<int, int>, std::size_t> cells;
    for (const Eigen::Vector2d& point : part.points_above) {
        const Eigen::Vector2d place = frame(point);
        ++cells[{static_cast<int>(place.x() / kCell), static_cast<int>(place.y() / kCell)}];
    }
    std::size_t most = 1;
    for (const auto& [cell, count] : cells) most = std::max(most, count);
    std::array<std::string, kLevels> levels;
    for (const auto& [cell, count] : cells) {
        const double share =
            std::log1p(static_cast<double>(count)) / std::log1p(static_cast<double>(most) + 1);
        const auto level = static_cast<std::size_t>(share * kLevels);
        levels.at(std::min<std::size_t>(level, kLevels - 1)) +=
            square(cell.first * kCell, cell.second * kCell, kCell);
    }
    for (int level = 0; level < kLevels; ++level)
        svg.path(levels.at(static_cast<std::size_t>(level)), class_of_level(level));
    for (const auto& [image, place] : part.cameras) {
        const Eigen::Vector2d at = frame(place);
        svg.circle(at.x(), at.y(), 2.5, "camera", facts.session.images[index_of(image)].name);
    }
    scale_bar(svg, frame, part.in_metres);
    return svg.finish();
}

std::string view_graph_plot(const PartFacts& part, const ReportFacts& facts, std::size_t most) {
    std::map<ImageId, Eigen::Vector2d> places(part.cameras.begin(), part.cameras.end());
    std::vector<const EdgeFact*> edges;
    for (const EdgeFact& edge : facts.edges) {
        if (places.contains(edge.pair.first) && places.contains(edge.pair.second))
            edges.push_back(&edge);
    }
    const auto is_against = [](const EdgeFact* edge) { return edge->state != EdgeState::kHolds; };
    std::ranges::stable_sort(edges, [&](const EdgeFact* a, const EdgeFact* b) {
        if (is_against(a) != is_against(b)) return is_against(a);
        return a->matches > b->matches;
    });
    if (edges.size() > most) edges.resize(most);
    PartFacts cameras_only;
    cameras_only.cameras = part.cameras;
    const GroundFrame frame = GroundFrame::of(cameras_only);
    Svg svg(kWide, frame.height + 10, "The view graph over where the photographs were taken");
    double largest = 1.0;
    for (const EdgeFact* edge : edges) largest = std::max(largest, std::log1p(edge->matches));
    std::array<std::string, kLevels> holds;
    std::string against;
    for (const EdgeFact* edge : edges) {
        const Eigen::Vector2d a = frame(places.at(edge->pair.first));
        const Eigen::Vector2d b = frame(places.at(edge->pair.second));
        const std::string stroke = 'M' + short_number(a.x(), 1) + ' ' + short_number(a.y(), 1) +
                                   'L' + short_number(b.x(), 1) + ' ' + short_number(b.y(), 1);
        const auto level = static_cast<std::size_t>(std::log1p(edge->matches) / largest * kLevels);
        (is_against(edge) ? against : holds.at(std::min<std::size_t>(level, kLevels - 1))) +=
            stroke;
    }
    for (int level = 0; level < kLevels; ++level)
        svg.path(holds.at(static_cast<std::size_t>(level)),
                 std::string("edge ").append(class_of_level(level)));
    svg.path(against, "edge against");
    for (const auto& [image, place] : part.cameras) {
        const Eigen::Vector2d at = frame(place);
        svg.circle(at.x(), at.y(), 2, "camera", facts.session.images[index_of(image)].name);
    }
    return svg.finish();
}

std::string match_matrix_plot(const ReportFacts& facts) {
    constexpr std::size_t kMostCells = 120;  // Format: squares along a side that can be told apart
    const std::size_t images = std::max<std::size_t>(facts.session.images.size(), 1);
    const std::size_t group = (images + kMostCells - 1) / kMostCells;
    const std::size_t cells = (images + group - 1) / group;
    std::vector<double> sums(cells * cells, 0.0);
    for (const EdgeFact& edge : facts.edges) {
        const std::size_t a = index_of(edge.pair.first) / group;
        const std::size_t b = index_of(edge.pair.second) / group;
        if (std::max(a, b) >= cells) continue;
        sums[a * cells + b] += edge.matches;
        if (a != b) sums[b * cells + a] += edge.matches;
    }
    const double most = std::log1p(sums.empty() ? 1.0 : std::max(std::ranges::max(sums), 1.0));
    const double cell = 440.0 / static_cast<double>(cells);
    std::array<std::string, kLevels> levels;
    for (std::size_t row = 0; row < cells; ++row) {
        for (std::size_t column = 0; column < cells; ++column) {
            const double sum = sums[row * cells + column];
            if (sum <= 0.0) continue;
            const auto level = static_cast<std::size_t>(std::log1p(sum) / most * kLevels);
            levels.at(std::min<std::size_t>(level, kLevels - 1)) +=
                square(static_cast<double>(column) * cell, static_cast<double>(row) * cell, cell);
        }
    }
    Svg svg(440, 440, "Matches between all images, in order of arrival");
    svg.rect(0, 0, 440, 440, "frame");
    for (int level = 0; level < kLevels; ++level)
        svg.path(levels.at(static_cast<std::size_t>(level)), class_of_level(level));
    return svg.finish();
}

std::string residual_plot(const CameraFacts& camera) {
    const Camera& shape = camera.after.empty() ? camera.before : camera.after.front().second;
    const double width = 420.0;  // Format: of a camera's map [px]
    const double height = width * shape.height / std::max(1U, shape.width);
    Svg svg(width, height, "Mean residuals over the photograph");
    const double cell_width = width / CameraFacts::kColumns;
    const double cell_height = height / CameraFacts::kRows;
    double largest = 1e-9, largest_mean = 1e-9;
    for (const ResidualCell& cell : camera.cells) {
        largest = std::max(largest, cell.mean_length_px);
        largest_mean = std::max(largest_mean, cell.mean_px.norm());
    }
    // The longest arrow takes most of a cell.
    const double stretch = 0.8 * std::min(cell_width, cell_height) / largest_mean;
    for (int row = 0; row < CameraFacts::kRows; ++row) {
        for (int column = 0; column < CameraFacts::kColumns; ++column) {
            const int number = row * CameraFacts::kColumns + column;
            const ResidualCell& cell = camera.cells.at(static_cast<std::size_t>(number));
            const double x = column * cell_width;
            const double y = row * cell_height;
            if (cell.count == 0) {
                svg.rect(x, y, cell_width, cell_height, "empty", "no observation");
                continue;
            }
            svg.rect(x, y, cell_width, cell_height,
                     level_class(0.999 * cell.mean_length_px / largest),
                     std::to_string(cell.count) + " observations, mean length " +
                         short_number(cell.mean_length_px, 2) + " px, mean vector " +
                         short_number(cell.mean_px.x(), 3) + ", " +
                         short_number(cell.mean_px.y(), 3) + " px");
            const Eigen::Vector2d middle(x + cell_width / 2, y + cell_height / 2);
            const Eigen::Vector2d tip = middle + stretch * cell.mean_px;
            svg.line(middle.x(), middle.y(), tip.x(), tip.y(), "arrow");
            svg.circle(middle.x(), middle.y(), 1.5, "arrow");
        }
    }
    return svg.finish();
}

std::string error_histogram_plot(const ReportFacts& facts) {
    std::vector<double> values;
    std::vector<std::string> labels;
    for (std::size_t i = 0; i < facts.error_histogram.size(); ++i) {
        values.push_back(static_cast<double>(facts.error_histogram[i]));
        labels.push_back(i % 5 == 0
                             ? short_number(static_cast<double>(i) * ReportFacts::kErrorStepPx, 1)
                             : std::string());
    }
    return bar_chart("Reprojection errors of all observations", values, labels,
                     "reprojection error [px]; the last bar holds all larger ones");
}

std::string track_length_plot(const ReportFacts& facts) {
    constexpr std::uint32_t kMost = 30;  // Format: longer tracks are in the last bar
    std::vector<double> values(kMost - 1, 0.0);
    std::vector<std::string> labels(kMost - 1);
    for (const auto& [length, points] : facts.track_lengths)
        values[std::min(std::max(length, 2U), kMost) - 2] += static_cast<double>(points);
    for (std::uint32_t length = 2; length <= kMost; length += 4)
        labels[length - 2] = std::to_string(length);
    return bar_chart("Points by how many images see them", values, labels,
                     "images that see a point; the last bar holds all with more");
}

std::string history_plot(const ReportFacts& facts) {
    std::vector<Series> series{{"images", "s0", {}}, {"placed", "s1", {}}, {"parts", "s2", {}}};
    for (const PastVersion& version : facts.session.versions) {
        const auto summary = decode_summary(version.summary_json);
        if (!summary.ok()) continue;  // Expected: damaged; told of where it is the latest
        const auto x = static_cast<double>(version.image_count);
        series[0].points.emplace_back(x, summary->counts.images);
        series[1].points.emplace_back(x, summary->counts.placed);
        series[2].points.emplace_back(x, version.effective_clusters);
    }
    return line_chart("Images, placed images and parts over the versions", series,
                      "images that had come");
}

}  // namespace psfm
