// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Whether a data set is as true as the model that it was made of (docs/exports.md): the median
// distance between features and their points' projections in both, and what is blank at pictures'
// edges.
//   dataset_errors MODEL DATASET     (`psfm export --format colmap` and `dataset`: DIR/0 of each)
#include <cstdio>
#include <iostream>

#include "storage/exchange/models/read_colmap.h"
#include "tests/tools/commands/dataset_truth.h"

int main(int argc, char** argv) {
    if (argc != 3) {
        std::cerr << "usage: dataset_errors MODEL DATASET\n";
        return 2;
    }
    const std::filesystem::path dataset = argv[2];
    const auto before = psfm::read_colmap_model(argv[1]);
    const auto after = psfm::read_colmap_model(dataset / "sparse" / "0");
    const auto borders = psfm::test::look_at_borders(dataset);
    if (!before || !after || !borders) {
        std::cerr << (!before  ? before.error().message
                      : !after ? after.error().message
                               : borders.error().message)
                  << '\n';
        return 1;
    }
    std::printf("%zu of %zu images, %zu of %zu points\n", after->images.size(),
                before->images.size(), after->points.size(), before->points.size());
    std::printf("median residual %.4f px, was %.4f px\n", psfm::test::median_residual_px(*after),
                psfm::test::median_residual_px(*before));
    std::printf("%zu pictures, %zu of a wrong size; longest blank part of an edge %.4f (%s)\n",
                borders->pictures, borders->wrong_sizes, borders->longest_blank,
                borders->blankest.c_str());
    return 0;
}
