// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/svg.h"

#include <gtest/gtest.h>

namespace psfm {
namespace {

TEST(Svg, NoTextBecomesMarkup) {
    EXPECT_EQ(escaped("<b a=\"1\" c='2'>&"), "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;");
    Svg svg(10, 10, "<script>");
    svg.circle(1, 1, 1, "camera", "</title><script>alert(1)</script>");
    svg.text(0, 0, "<img onerror=1>");
    const std::string html = svg.finish();
    EXPECT_EQ(html.find("<script"), std::string::npos);
    EXPECT_EQ(html.find("<img"), std::string::npos);
}

TEST(Svg, NumbersAreShort) {
    EXPECT_EQ(short_number(1.50, 2), "1.5");
    EXPECT_EQ(short_number(2.0, 2), "2");
    EXPECT_EQ(short_number(-0.001, 2), "0");
    EXPECT_EQ(short_number(100.0, 0), "100");
    EXPECT_EQ(short_number(1.0 / 0.0, 2), "0");
}

TEST(Svg, StepsAreRound) {
    EXPECT_DOUBLE_EQ(round_step(10.0), 2.0);
    EXPECT_DOUBLE_EQ(round_step(7.0), 2.0);
    EXPECT_DOUBLE_EQ(round_step(600.0), 200.0);
    EXPECT_DOUBLE_EQ(round_step(0.26), 0.1);
}

TEST(Svg, ABarIsAsHighAsItsValue) {
    const std::string chart = bar_chart("t", {1.0, 2.0}, {"a", "b"}, "x");
    // Plot height 172 px: half of it, and all of it.
    EXPECT_NE(chart.find("height=\"86\""), std::string::npos) << chart;
    EXPECT_NE(chart.find("height=\"172\""), std::string::npos) << chart;
}

TEST(Svg, ChartsOfNothingAreCharts) {
    EXPECT_NE(bar_chart("t", {}, {}, "x").find("</svg>"), std::string::npos);
    EXPECT_NE(line_chart("t", {{"a", "s0", {}}}, "x").find("</svg>"), std::string::npos);
}

}  // namespace
}  // namespace psfm
