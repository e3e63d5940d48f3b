// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Real references of shared/datasets, disturbed by a known amount.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "stages/evaluation/evaluate_model.h"
#include "storage/exchange/models/read_colmap.h"
#include "tests/stages/evaluation/pose_lists.h"

namespace psfm {
namespace {

struct Dataset {
    const char* folder;
    std::size_t images;
};

class RealReferences : public testing::TestWithParam<Dataset> {
  protected:
    void SetUp() override {
        const char* datasets = std::getenv("PSFM_DATASETS");
        if (datasets == nullptr) GTEST_SKIP() << "PSFM_DATASETS is not set";
        const auto model = read_colmap_model(std::filesystem::path(datasets) / GetParam().folder);
        ASSERT_TRUE(model.ok()) << model.error().message;
        for (const ExportedImage& image : model->images) {
            reference_.push_back({image.name, image.cam_from_world});
        }
        ASSERT_EQ(reference_.size(), GetParam().images);
    }

    std::vector<NamedPose> reference_;
};

TEST_P(RealReferences, PlantedOutliersAreCounted) {
    const double threshold = *outlier_threshold(reference_, {});
    auto model = reference_;
    const std::size_t planted = reference_.size() / 4;
    synthetic::Rng rng(reference_.size());
    for (NamedPose& pose : model) test::shift_centre(pose, 0.02 * threshold * rng.normal3());
    for (const std::size_t i : synthetic::random_order(model.size(), 1)) {
        if (i < planted) test::shift_centre(model[i], 3.0 * threshold * rng.direction());
    }
    const auto evaluation =
        evaluate_model(reference_, test::moved(model, test::some_similarity(2)));
    ASSERT_TRUE(evaluation.ok());
    EXPECT_EQ(evaluation->outliers, planted);
    EXPECT_LT(evaluation->position_median, 0.1 * threshold);
    EXPECT_GT(evaluation->position_rms, threshold);
}

INSTANTIATE_TEST_SUITE_P(Datasets, RealReferences,
                         testing::Values(Dataset{"strecha-half/fountain-P11/gt", 11},
                                         Dataset{"strecha-half/Herz-Jesus-P8/gt", 8},
                                         Dataset{"strecha-half/entry-P10/gt", 10},
                                         Dataset{"strecha-half/castle-P19/gt", 19},
                                         Dataset{"duplicates/books/reference", 21},
                                         Dataset{"temple-341/gt", 341},
                                         Dataset{"quad-streams/gt", 600}));

}  // namespace
}  // namespace psfm
