// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace psfm {

/// Text as it may stand in HTML and SVG, also inside of quotes: no name becomes markup.
std::string escaped(std::string_view text);

/// A number with at most so many digits after the point, without zeros at its end.
std::string short_number(double value, int digits);

/// A plot as an <svg> element: readable without script, and in print. Coordinates [px] from the
/// top-left corner. Each has a title, which is what a screen reader says.
class Svg {
  public:
    Svg(double width, double height, std::string_view title);

    void line(double x1, double y1, double x2, double y2, std::string_view classes);
    void rect(double x, double y, double width, double height, std::string_view classes,
              std::string_view tip = {});
    void circle(double x, double y, double radius, std::string_view classes,
                std::string_view tip = {});
    void text(double x, double y, std::string_view text, std::string_view classes = "");
    /// Many strokes as one element. @param data  of the attribute d
    void path(const std::string& data, std::string_view classes);
    /// A group with a colour of its own: "fill" or "stroke" by CSS.
    std::string finish() const;

  private:
    std::string body_;
};

/// Bars side by side, with the axis below. @param labels  one a bar; empty ones are not written
std::string bar_chart(std::string_view title, const std::vector<double>& values,
                      const std::vector<std::string>& labels, std::string_view x_name);

struct Series {
    std::string name;
    std::string classes;  ///< how it is drawn
    std::vector<std::pair<double, double>> points;
};
/// Lines over a common axis, each named at its end.
std::string line_chart(std::string_view title, const std::vector<Series>& series,
                       std::string_view x_name);

/// A round step for some five marks up to `largest`: 1, 2 or 5 times a power of ten.
double round_step(double largest);

}  // namespace psfm
