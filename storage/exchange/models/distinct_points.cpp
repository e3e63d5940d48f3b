// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/distinct_points.h"

#include <algorithm>
#include <array>
#include <utility>

namespace psfm {

std::vector<std::size_t> distinct_points(std::span<const ExportedPoint> points,
                                         const Eigen::Vector3d& origin) {
    std::vector<std::pair<std::array<float, 3>, std::size_t>> places;
    places.reserve(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
        const Eigen::Vector3d place = points[p].position - origin;
        places.push_back({{static_cast<float>(place.x()), static_cast<float>(place.y()),
                           static_cast<float>(place.z())},
                          p});
    }
    std::ranges::sort(places);  // of one place, the lowest number first
    const auto is_one = [](const auto& a, const auto& b) { return a.first == b.first; };
    places.erase(std::unique(places.begin(), places.end(), is_one), places.end());
    std::vector<std::size_t> numbers;
    numbers.reserve(places.size());
    for (const auto& [place, number] : places) numbers.push_back(number);
    std::ranges::sort(numbers);
    return numbers;
}

}  // namespace psfm
