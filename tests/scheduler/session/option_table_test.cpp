// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/option_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "scheduler/session/presets.h"

namespace psfm {
namespace {

TEST(OptionTable, EveryNameSetsItsOwnFieldAndDefaultsLieInTheirRanges) {
    const StageOptions defaults;
    for (const NamedOption& option : option_table()) {
        SCOPED_TRACE(option.name);
        EXPECT_GE(option.get(defaults), option.low);
        EXPECT_LE(option.get(defaults), option.high);
        StageOptions changed;
        const double other = option.get(defaults) == option.low ? option.high : option.low;
        option.set(changed, other);
        EXPECT_EQ(option.get(changed), other);
        for (const NamedOption& unchanged : option_table()) {
            if (unchanged.name != option.name) {
                EXPECT_EQ(unchanged.get(changed), unchanged.get(defaults)) << unchanged.name;
            }
        }
    }
}

TEST(OptionTable, IsSortedAndSaysWhatEachIsAndWhereItComesFrom) {
    EXPECT_TRUE(std::ranges::is_sorted(option_table(), {}, &NamedOption::name));
    for (const NamedOption& option : option_table()) {
        EXPECT_FALSE(option.what.empty()) << option.name;
        EXPECT_FALSE(option.source.empty()) << option.name;
    }
}

TEST(OptionTable, PresetsAreReadToTheirLastLine) {
    for (const char* name : {"paper", "0.1"}) {
        const auto text = preset_text(name);
        ASSERT_TRUE(text) << name;
        const auto options = preset_options(name);
        ASSERT_TRUE(options) << name << " names an option that there is not";
        std::size_t lines = 0;
        for (std::size_t i = 0; i + 1 < text->size(); ++i)
            lines += (*text)[i] == '\n' && std::islower((*text)[i + 1]) != 0 ? 1 : 0;
        EXPECT_EQ(options->size(), lines) << name;
        StageOptions set;
        EXPECT_TRUE(set_options(set, *options).ok()) << name;
    }
    EXPECT_TRUE(preset_options("default")->empty());
    EXPECT_FALSE(preset_options("other"));
    SessionConfig paper;
    paper.preset = "paper";
    EXPECT_FALSE(stage_options(paper)->solve.plausibility);
    EXPECT_EQ(stage_options(paper)->clustering.form, JaccardForm::kLiteral);
}

TEST(OptionTable, OfThePaperEachValueHasItsSectionOrADash) {
    const auto text = preset_text("paper");
    ASSERT_TRUE(text);
    std::istringstream lines{std::string(*text)};
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line.front() == '#') continue;
        const std::size_t at = line.find(" # ");
        ASSERT_NE(at, std::string::npos) << line;
        const std::string source = line.substr(at + 3);
        EXPECT_TRUE(source == "-" || source.starts_with('"')) << line;
    }
}

TEST(OptionTable, ThePaperSetsOnlyWhatIsOtherwiseByDefault) {
    const auto options = preset_options("paper");
    ASSERT_TRUE(options);
    const StageOptions defaults;
    for (const NamedOption& option : option_table()) {
        const auto set = options->find(std::string(option.name));
        if (set == options->end()) continue;
        EXPECT_NE(set->second, option.get(defaults)) << option.name;
    }
}

TEST(OptionTable, SettingsAreNumbersInTheirRanges) {
    const auto setting = parse_setting("clustering.eta=0.25");
    ASSERT_TRUE(setting.ok());
    EXPECT_EQ(*setting, std::pair(std::string("clustering.eta"), 0.25));
    EXPECT_FALSE(parse_setting("clustering.eta").ok());
    EXPECT_FALSE(parse_setting("clustering.eta=").ok());
    EXPECT_FALSE(parse_setting("clustering.eta=0.2x").ok());
    const auto unknown = parse_setting("solve.eta=1");
    ASSERT_FALSE(unknown.ok());
    EXPECT_NE(unknown.error().message.find("clustering.eta"), std::string::npos)
        << "what may have been meant is named";
    StageOptions options;
    EXPECT_FALSE(set_options(options, {{"clustering.eta", 1.5}}).ok());
    EXPECT_FALSE(set_options(options, {{"clustering.eta", NAN}}).ok());
    ASSERT_TRUE(set_options(options, {{"clustering.eta", 0.25}}).ok());
    EXPECT_EQ(options.clustering.eta, 0.25);
}

TEST(OptionTable, ASessionGoesOnWithTheOptionsThatItStored) {
    SessionConfig config;
    config.options = option_values(*stage_options(config));
    config.options["clustering.eta"] = 0.4;
    const auto back = decode_config(encode_config(config));
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->options, config.options);
    EXPECT_EQ(stage_options(*back)->clustering.eta, 0.4);
}

TEST(OptionTable, ASessionMayHaveStoredAnOptionThatIsNoMore) {
    SessionConfig config;
    config.options = option_values(*stage_options(config));
    config.options["solve.policy.places.whole_up_to"] = 1000.0;
    EXPECT_TRUE(stage_options(config).ok());
    const auto set = parse_setting("solve.policy.places.whole_up_to=1000");
    ASSERT_FALSE(set.ok()) << "not any more";
    EXPECT_NE(set.error().message.find("solve.policy.affordable_up_to"), std::string::npos)
        << set.error().message;
}

TEST(OptionTable, WhatAnOptionThatIsNoMoreSaidHolds) {
    SessionConfig config;
    config.options = {{"clustering.hold_from", 7.0}, {"clustering.join_up_to", 25.0}};
    const auto stored = stage_options(config);
    ASSERT_TRUE(stored.ok()) << stored.error().message;
    EXPECT_TRUE(may_join(6, 40, stored->clustering));
    EXPECT_FALSE(may_join(7, 40, stored->clustering)) << "seven twenty-fifths are seven";
    const auto set = parse_setting("clustering.hold_from=50");
    ASSERT_TRUE(set.ok()) << set.error().message;
    config.options = {*set};
    EXPECT_DOUBLE_EQ(stage_options(config)->clustering.hold_part, 0.05);
    config.options = {*parse_setting("clustering.hold_from=1")};
    EXPECT_FALSE(stage_options(config).ok()) << "it was 2 at least";
    config.options = {*set};
    config.options["clustering.hold_part"] = 0.2;
    EXPECT_DOUBLE_EQ(stage_options(config)->clustering.hold_part, 0.2);
}

TEST(OptionTable, SessionsFromBeforeGoOnAsTheyBegan) {
    auto settings = nlohmann::json::parse(encode_config(SessionConfig{}));
    settings.erase("options");
    const auto config = decode_config(settings.dump());
    ASSERT_TRUE(config.ok()) << config.error().message;
    const auto options = stage_options(*config);
    ASSERT_TRUE(options.ok()) << options.error().message;
    EXPECT_EQ(options->clustering.join_below, 0U);
    EXPECT_EQ(options->edges.min_weak_inliers, 0U);
    EXPECT_EQ(options->verification.verify.min_inlier_ratio, 0.25);
}

}  // namespace
}  // namespace psfm
