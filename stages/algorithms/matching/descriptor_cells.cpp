// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/matching/descriptor_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "stages/algorithms/matching/k_means.h"
#include "stages/algorithms/matching/match_criteria.h"
#include "stages/algorithms/matching/match_with_kernel.h"
#include "stages/algorithms/matching/nearest_descriptors.h"
#include "stages/algorithms/matching/rows_by_cell.h"

namespace psfm {
namespace {

constexpr std::size_t kGroupColumns = kStripColumns * kStripGroup;
/// Guard: keys of so many rows are written at a time: they stay in the cache until they are read.
constexpr std::size_t kRowsAtOnce = 256;
/// Guard: cells whose keys fit one block of a kernel's positions.
constexpr std::size_t kMaxCells = 255 * kStripColumns;

/// Guard: of time: rows that k-means looks at for each cell. Ours; not tuned.
constexpr std::size_t kRowsACell = 16;

/// Every so many-th row, so many that k-means looks at that many a cell or all.
std::vector<std::uint8_t> sample(const Descriptors& descriptors, std::size_t cells) {
    const std::size_t step = std::max<std::size_t>(1, descriptors.rows() / (kRowsACell * cells));
    std::vector<std::uint8_t> rows;
    rows.reserve((descriptors.rows() / step + 1) * Descriptors::kSize);
    for (std::size_t i = 0; i < descriptors.rows(); i += step)
        rows.insert(rows.end(), descriptors.row(i), descriptors.row(i) + Descriptors::kSize);
    return rows;
}

/// The descriptors that are compared with cells.
struct Rows {
    explicit Rows(const Descriptors& of) : descriptors(of), sums(sums_of(of.values)) {}
    /// A product's rows from the given one on, as a kernel reads them.
    DotKernelInput from(std::size_t row) const {
        DotKernelInput input;
        input.rows = descriptors.row(row);
        input.row_norms = sums.norms.data() + row;
        input.row_sums = sums.sums.data() + row;
        input.row_count = descriptors.rows() - row;
        return input;
    }

    const Descriptors& descriptors;
    RowSums sums;
};

/// Which of the rows [begin, end) are compared with which cell.
class RowsOfCells {
  public:
    RowsOfCells(const Rows& rows, std::size_t begin, std::size_t end, const DescriptorCells& cells,
                const CellOptions& options, DistanceKernel kernel)
        : rows_(end - begin),
          lists_(std::make_unique_for_overwrite<std::uint32_t[]>(rows_ * cells.cells.size())),
          counts_(cells.cells.size(), 0) {
        const std::size_t strips = cells.centres.strips.size();
        const auto excess = static_cast<std::int64_t>(
            std::llround(options.max_excess * MatchCriteria::kUnit * MatchCriteria::kUnit *
                         static_cast<double>(kKeyUnit)));
        std::vector<StripKeys> keys(kRowsAtOnce * strips);
        for (std::size_t first = begin; first < end; first += kRowsAtOnce) {
            DotKernelInput input = rows.from(first);
            input.row_count = std::min(kRowsAtOnce, end - first);
            input.strips = cells.centres.strips.data();
            input.column_norms = cells.centres.norms.data();
            input.column_count = cells.centres.rows;
            kernel(input, keys.data());
            for (std::size_t r = 0; r < input.row_count; ++r)
                take_row(first + r, keys[r * strips].lane, excess);
        }
    }

    std::span<const std::uint32_t> of(std::size_t cell) const {
        return {lists_.get() + cell * rows_, counts_[cell]};
    }

  private:
    void take_row(std::size_t row, const std::int32_t* keys, std::int64_t excess) {
        std::int32_t nearest = keys[0];
        for (std::size_t c = 1; c < counts_.size(); ++c) nearest = std::min(nearest, keys[c]);
        constexpr std::int64_t kLargest = std::numeric_limits<std::int32_t>::max();
        const auto limit = static_cast<std::int32_t>(std::min(nearest + excess, kLargest));
        for (std::size_t c = 0; c < counts_.size(); ++c) {
            lists_[c * rows_ + counts_[c]] = static_cast<std::uint32_t>(row);
            counts_[c] += keys[c] <= limit ? 1 : 0;
        }
    }

    std::size_t rows_;
    std::unique_ptr<std::uint32_t[]> lists_;  // rows_ entries a cell
    std::vector<std::size_t> counts_;
};

/// One image compared with parts of another.
class CellComparison {
  public:
    CellComparison(const Descriptors& a, const DescriptorCells& cells, const CellOptions& options,
                   const NamedDotKernel& kernel)
        : rows_(a),
          cells_(cells),
          options_(options),
          kernel_(kernel),
          of_rows_(a.rows()),
          of_columns_(cells.norms.size()) {
        std::size_t most_strips = 0;
        for (const DescriptorCells::Cell& cell : cells.cells)
            most_strips = std::max(most_strips, strip_count(cell.rows));
        column_keys_.resize(most_strips);
        column_minima_.resize(most_strips);
    }

    void compare_rows(std::size_t begin, std::size_t end) {
        const RowsOfCells rows(rows_, begin, end, cells_, options_, kernel_.distances);
        for (std::size_t c = 0; c < cells_.cells.size(); ++c) {
            const std::span<const std::uint32_t> some = rows.of(c);
            if (some.empty()) continue;
            const std::size_t first = cells_.cells[c].first_column;
            DotKernelInput input = rows_.from(0);
            input.row_numbers = some.data();
            input.row_count = some.size();
            input.strips = cells_.strips.data() + first / kStripColumns;
            input.column_norms = cells_.norms.data() + first;
            input.column_count = cells_.cells[c].rows;
            input.first_column = first;
            kernel_.kernel(input, {.of_rows = of_rows_.view(),
                                   .of_columns = of_columns_.view(first),
                                   .column_keys = column_keys_.data(),
                                   .column_minima = column_minima_.data()});
        }
    }

    /// Matches as far as the rows [0, end) were compared.
    std::vector<FeatureMatch> matches(std::size_t end, const MatchCriteria& criteria) const {
        std::vector<FeatureMatch> matches;
        for (std::uint32_t i = 0; i < end; ++i) {
            const std::size_t column = of_rows_.index[i];
            if (of_columns_.index[column] != i) continue;
            const std::int32_t own = rows_.sums.norms[i];
            const double squared = MatchCriteria::squared(of_rows_.best[i], own);
            if (criteria.near_enough(squared) &&
                criteria.distinct(squared, of_rows_.second[i], own) &&
                criteria.distinct(squared, of_columns_.second[column], cells_.norms[column]))
                matches.push_back({i, cells_.row_of_column[column]});
        }
        return matches;
    }

  private:
    Rows rows_;
    const DescriptorCells& cells_;
    const CellOptions& options_;
    const NamedDotKernel& kernel_;
    NearestArrays of_rows_;
    NearestArrays of_columns_;
    std::vector<StripKeys> column_keys_;     // scratch
    std::vector<LaneMinima> column_minima_;  // scratch
};

}  // namespace

Result<void> validate(const CellOptions& options) {
    if (options.rows_per_cell == 0)
        return Error{ErrorCode::kInvalidArgument, "matching: rows_per_cell must be at least 1"};
    if (options.strongest_rows == 0)
        return Error{ErrorCode::kInvalidArgument, "matching: strongest_rows must be at least 1"};
    if (!(options.max_excess >= 0.0 && options.max_excess <= 4.0))
        return Error{ErrorCode::kInvalidArgument, "matching: max_excess must lie in [0, 4]"};
    return {};
}

DescriptorCells divide(const Descriptors& descriptors, const CellOptions& options) {
    DescriptorCells divided;
    if (descriptors.rows() == 0) return divided;
    const std::size_t wanted =
        std::clamp<std::size_t>(descriptors.rows() / options.rows_per_cell, 1, kMaxCells);
    const Descriptors means =
        k_means(sample(descriptors, wanted), wanted, options.iterations, /*seed=*/1);
    const std::vector<CellRows> cells = rows_by_cell(
        descriptors.values, nearest_descriptors(descriptors.values, pack(means)), means.rows());
    Descriptors centres;
    centres.values.reserve(cells.size() * Descriptors::kSize);
    const std::size_t padded_columns = descriptors.rows() + cells.size() * kGroupColumns;
    divided.strips.reserve(padded_columns / kStripColumns);
    divided.norms.reserve(padded_columns);
    divided.row_of_column.reserve(padded_columns);
    divided.cells.reserve(cells.size());
    for (const CellRows& cell : cells) {
        const PackedDescriptors packed = pack(cell.descriptors);
        const std::size_t first = divided.norms.size();
        divided.cells.push_back({first, packed.rows});
        divided.strips.insert(divided.strips.end(), packed.strips.begin(), packed.strips.end());
        divided.norms.insert(divided.norms.end(), packed.norms.begin(), packed.norms.end());
        divided.row_of_column.insert(divided.row_of_column.end(), cell.rows.begin(),
                                     cell.rows.end());
        divided.norms.resize(divided.strips.size() * kStripColumns, 0);
        divided.row_of_column.resize(divided.norms.size(), 0);
        const std::uint8_t* centre = means.row(cell.cell);
        centres.values.insert(centres.values.end(), centre, centre + Descriptors::kSize);
    }
    divided.centres = pack(centres);
    return divided;
}

std::optional<std::vector<FeatureMatch>> match_in_cells_with_kernel(const Descriptors& a,
                                                                    const DescriptorCells& b,
                                                                    const MatchOptions& options,
                                                                    const CellOptions& cells,
                                                                    const NamedDotKernel& kernel) {
    if (a.rows() == 0 || b.cells.empty()) return std::vector<FeatureMatch>();
    const MatchCriteria criteria(options);
    CellComparison comparison(a, b, cells, kernel);
    const std::size_t strongest =
        cells.min_strongest_matches > 0 ? std::min(cells.strongest_rows, a.rows()) : 0;
    if (strongest > 0) {
        comparison.compare_rows(0, strongest);
        if (comparison.matches(strongest, criteria).size() < cells.min_strongest_matches)
            return std::nullopt;
    }
    comparison.compare_rows(strongest, a.rows());
    return comparison.matches(a.rows(), criteria);
}

std::optional<std::vector<FeatureMatch>> match_in_cells(const Descriptors& a,
                                                        const DescriptorCells& b,
                                                        const MatchOptions& options,
                                                        const CellOptions& cells) {
    return match_in_cells_with_kernel(a, b, options, cells, available_dot_kernels().front());
}

PreparedDescriptors prepare(const Descriptors& descriptors, const CellOptions& options) {
    PreparedDescriptors prepared{pack(descriptors), {}};
    if (descriptors.rows() >= options.min_rows) prepared.cells = divide(descriptors, options);
    return prepared;
}

std::optional<std::vector<FeatureMatch>> match_images(const Descriptors& a, const Descriptors& b,
                                                      const PreparedDescriptors& prepared_b,
                                                      bool divide_b, const MatchOptions& options,
                                                      const CellOptions& cells) {
    if (std::min(a.rows(), b.rows()) < cells.min_rows)
        return match_descriptors(a, prepared_b.packed, options);
    if (divide_b) return match_in_cells(a, prepared_b.cells, options, cells);
    auto matches = match_in_cells(b, divide(a, cells), options, cells);
    if (!matches) return matches;
    for (FeatureMatch& match : *matches) std::swap(match.first, match.second);
    std::ranges::sort(*matches, {}, &FeatureMatch::first);
    return matches;
}

}  // namespace psfm
