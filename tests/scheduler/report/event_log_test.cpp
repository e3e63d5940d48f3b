// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/report/event_log.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>

namespace psfm {
namespace {

TEST(LogLine, ImageHasTheKeysThatScriptsRelyOn) {
    ImageReport image;
    image.index = 36;
    image.name = "a \"quoted\" name.jpg";
    image.latency_ms = 12.34;
    image.solve_ms = 5.0;
    SessionCounts counts;
    counts.clusters = counts.effective_clusters = 2;
    counts.placed = 30;
    counts.waiting = 6;
    const auto line = nlohmann::json::parse(log_line(image, counts));
    EXPECT_EQ(line.at("event"), "image");
    EXPECT_EQ(line.at("index"), 36);
    EXPECT_EQ(line.at("name"), image.name);
    EXPECT_EQ(line.at("clusters"), 2);
    EXPECT_EQ(line.at("effective_clusters"), 2);
    EXPECT_EQ(line.at("placed"), 30);
    EXPECT_EQ(line.at("waiting"), 6);
    EXPECT_EQ(line.at("resets"), 0);
    EXPECT_NEAR(line.at("latency_ms").get<double>(), 12.3, 1e-9);
    for (const char* stage : {"extract", "retrieve", "verify", "cluster", "solve", "merge"}) {
        EXPECT_TRUE(line.at("stages_ms").contains(stage)) << stage;
    }
}

TEST(LogLine, EventsCarryTheirDetails) {
    SessionEvent event;
    event.kind = SessionEvent::Kind::kSolve;
    event.text = "new";
    event.clusters = {3};
    event.detail_json = R"({"milliseconds":7.5})";
    const auto line = nlohmann::json::parse(log_line(event));
    EXPECT_EQ(line.at("event"), "solve");
    EXPECT_EQ(line.at("clusters"), nlohmann::json({3}));
    EXPECT_EQ(line.at("milliseconds"), 7.5);
}

TEST(LogLine, NamesThatAreNoUtf8DoNotThrow) {
    ImageReport image;
    image.name = "\xFF\xFE.jpg";
    EXPECT_NO_THROW(log_line(image, {}));
}

TEST(LogLine, NodesTellWhatTheyDidWithTheirTime) {
    GraphUsage usage;
    usage.seconds = 10.0;
    usage.threads = 3;
    usage.nodes.push_back({GraphNode::kSolve, 7, 6.25, 1.5, 2.25, 8.0, 1.75});
    const auto line = nlohmann::json::parse(log_line(usage));
    EXPECT_EQ(line.at("event"), "nodes");
    EXPECT_EQ(line.at("seconds"), 10.0);
    EXPECT_EQ(line.at("threads"), 3);
    const auto& node = line.at("nodes").at(0);
    EXPECT_EQ(node.at("node"), "solve");
    EXPECT_EQ(node.at("runs"), 7);
    EXPECT_EQ(node.at("busy_s"), 6.25);
    EXPECT_EQ(node.at("waiting_s"), 1.5);
    EXPECT_EQ(node.at("starved_s"), 2.25);
    EXPECT_EQ(node.at("work_s"), 8.0);
    EXPECT_EQ(node.at("queued_s"), 1.75);
}

TEST(EventLog, AppendsLinesAndRefusesFolders) {
    const auto file =
        std::filesystem::temp_directory_path() / ("psfm_log_" + std::to_string(getpid()));
    PublishMessage publish;
    publish.images.resize(2);
    publish.events.resize(1);
    for (int run = 0; run < 2; ++run) {
        auto log = EventLog::open(file);
        ASSERT_TRUE(log.ok());
        (*log)->write(publish);
        (*log)->write(GraphUsage{});
        EXPECT_TRUE((*log)->good());
    }
    std::ifstream stream(file);
    std::string line;
    int lines = 0;
    while (std::getline(stream, line)) ++lines;
    EXPECT_EQ(lines, 8);
    std::filesystem::remove(file);

    std::ofstream(file) << R"({"event":"ima)";  // killed while it wrote
    (*EventLog::open(file))->write(publish);
    std::ifstream torn(file);
    std::getline(torn, line);
    EXPECT_EQ(line, R"({"event":"ima)") << "what follows has lines of its own";
    std::filesystem::remove(file);
    EXPECT_FALSE(EventLog::open(std::filesystem::temp_directory_path()).ok());
}

TEST(EventLog, WritesWhatDidNotFitAsSoonAsItDoes) {
    const auto file =
        std::filesystem::temp_directory_path() / ("psfm_full_" + std::to_string(getpid()));
    PublishMessage publish;
    publish.images.resize(3);
    auto log = *EventLog::open(file);
    log->write(publish);
    const auto before = std::filesystem::file_size(file);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit unlimited{};
    getrlimit(RLIMIT_FSIZE, &unlimited);
    rlimit full = unlimited;
    full.rlim_cur = before + before / 2;  // in the middle of a line
    setrlimit(RLIMIT_FSIZE, &full);
    log->write(publish);
    log->write(publish);
    EXPECT_FALSE(log->good());
    EXPECT_EQ(std::filesystem::file_size(file), full.rlim_cur);
    setrlimit(RLIMIT_FSIZE, &unlimited);
    log->write(GraphUsage{});
    EXPECT_TRUE(log->good());
    std::ifstream stream(file);
    std::string line;
    int images = 0;
    while (std::getline(stream, line))
        images += nlohmann::json::parse(line).at("event") == "image" ? 1 : 0;
    EXPECT_EQ(images, 9) << "none is lost, torn or there twice";
    std::filesystem::remove(file);
}

TEST(EventLog, OneMessageOfAnySizeIsWritten) {
    const auto file =
        std::filesystem::temp_directory_path() / ("psfm_long_" + std::to_string(getpid()));
    PublishMessage publish;
    publish.images.resize(100'000);
    auto log = *EventLog::open(file);
    log->write(publish);
    EXPECT_TRUE(log->good());
    std::ifstream stream(file);
    std::string line;
    std::size_t lines = 0;
    while (std::getline(stream, line)) ++lines;
    EXPECT_EQ(lines, publish.images.size());
    EXPECT_GT(std::filesystem::file_size(file), std::size_t{20} << 20U) << "more than is kept";
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace psfm
