// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/weak_model.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TEST(DescribeWeakModel, ALineForEachWay) {
    WeakModel model{ClusterId{4}, 9, {}};
    EXPECT_TRUE(describe(model).empty());
    model.weaknesses.add(Weakness::kFewPoints);
    model.weaknesses.add(Weakness::kSmallAngles);
    const auto lines = describe(model);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_TRUE(lines.front().starts_with("the model of 9 images in cluster 4 is weak: "));
}

}  // namespace
}  // namespace psfm
