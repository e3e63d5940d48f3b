// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/console/progress.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>

#include "tools/report/run_state.h"

namespace psfm {
namespace {

TEST(Progress, TellsOfSettlingThatBeginsWithTheLastPhotographs) {
    std::string pattern = (std::filesystem::temp_directory_path() / "psfm-XXXXXX").string();
    const std::filesystem::path folder = mkdtemp(pattern.data());
    {
        Progress progress(folder, 2, nullptr);
        PublishMessage publish;
        publish.images.resize(2);
        SessionEvent settle;
        settle.kind = SessionEvent::Kind::kSettle;
        settle.clusters = {0};
        settle.cluster_images = {2};
        publish.events = {settle};
        progress.on_publish(publish);
        std::optional<RunState> state;
        for (int tenth = 0; tenth < 200 && !(state && state->settling); ++tenth) {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            state = read_run_state(folder);
        }
        ASSERT_TRUE(state.has_value());
        EXPECT_TRUE(state->settling);
        EXPECT_EQ(state->done, 2U);
    }
    EXPECT_FALSE(read_run_state(folder).has_value());
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace psfm
