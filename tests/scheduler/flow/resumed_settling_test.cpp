// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A process that takes a session up in which an earlier one was settling.
#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <utility>

#include "scheduler/flow/committer.h"
#include "stages/reconstruction/solve/solve_cluster.h"
#include "tests/scheduler/flow/serial_session.h"
#include "tests/scheduler/session/made_up_clusters.h"
#include "tests/stages/reconstruction/two_parts.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

/// Of two models the first has settled, and is not shown yet; the second is dirty.
void settle_first_of_two(ClusterTable& clusters) {
    const auto taken = clusters.take_unsettled();
    ASSERT_EQ(taken.size(), 2U);
    test::Solve settled = test::solve_of(*taken.front(), taken.front()->membership.members, true);
    const ClusterId dirty = taken.back()->id;
    clusters.finish(settled.problem, settled.solution);
    clusters.put_off(dirty);
    clusters.make_dirty(std::span(&dirty, 1));
}

/// It takes all solutions together: one that is given up for a photograph would never come.
TEST(ResumedSettling, OfADeterministicSessionGivesWayToNoPhotograph) {
    const TwoParts parts;
    const auto pairs = parts.pairs(0.7, 0);
    const testing::TemporaryFolder folder;
    const auto store = test::open_store(folder);
    {
        test::SerialSession session(*store, parts.scene, pairs);
        for (std::uint32_t i = 0; i < TwoParts::kImages; ++i) ASSERT_TRUE(session.add_image());
    }
    SessionConfig config;
    config.deterministic = true;
    config.fix_intrinsics = true;
    const auto options = stage_options(config);
    ASSERT_TRUE(options.ok());
    auto session = restore_session(*store, config, *options);
    ASSERT_TRUE(session.ok());
    settle_first_of_two(session->state.clusters);
    Committer committer(*store, config, *options, std::move(session->state));
    auto output = committer.handle(CatchUp{});
    ASSERT_TRUE(output.ok());
    ASSERT_EQ(output->solves.size(), 1U);
    const SolveMessage first = output->solves.front();
    ASSERT_TRUE(committer.handle(SourceIdle{0, true}).ok()) << "it watches, and nothing comes";
    output = committer.handle(
        SolvedMessage{first.problem, std::make_shared<const Result<ClusterSolution>>(
                                         solve_cluster(*first.problem, options->solve))});
    ASSERT_TRUE(output.ok());
    ASSERT_EQ(output->solves.size(), 1U);
    EXPECT_TRUE(output->solves.front().problem->settle);
    EXPECT_FALSE(output->solves.front().is_interim);
}

}  // namespace
}  // namespace psfm
