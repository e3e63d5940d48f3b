// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/svg.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace psfm {
namespace {

/// Format: a plot and its margins [px].
constexpr double kWidth = 640.0;
constexpr double kHeight = 220.0;
constexpr double kLeft = 52.0, kRight = 12.0, kTop = 10.0, kBottom = 38.0;
constexpr double kPlotWidth = kWidth - kLeft - kRight;
constexpr double kPlotHeight = kHeight - kTop - kBottom;

std::string attribute(std::string_view name, double value) {
    std::string text(1, ' ');
    text.append(name).append("=\"").append(short_number(value, 2)).push_back('"');
    return text;
}

std::string class_attribute(std::string_view classes) {
    if (classes.empty()) return {};
    std::string text(" class=\"");
    text.append(classes).push_back('"');
    return text;
}

std::string closed(std::string_view element, std::string_view tip) {
    if (tip.empty()) return "/>";
    return "><title>" + escaped(tip) + "</title></" + std::string(element) + '>';
}

void horizontal_grid(Svg& svg, double largest) {
    const double step = round_step(largest);
    for (double mark = 0.0; mark <= largest * 1.0001; mark += step) {
        const double y = kTop + kPlotHeight * (1.0 - mark / largest);
        svg.line(kLeft, y, kWidth - kRight, y, "grid");
        svg.text(kLeft - 6, y + 4, short_number(mark, 2), "end");
    }
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::string short_number(double value, int digits) {
    if (!std::isfinite(value)) return "0";
    char text[64];
    std::snprintf(text, sizeof(text), "%.*f", digits, value);
    std::string number = text;
    if (number.find('.') != std::string::npos) {
        number.erase(number.find_last_not_of('0') + 1);
        if (number.back() == '.') number.pop_back();
    }
    return number == "-0" ? "0" : number;
}

double round_step(double largest) {
    const double rough = std::max(largest, 1e-9) / 5.0;
    const double power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (factor * power >= rough) return factor * power;
    }
    return 10.0 * power;
}

Svg::Svg(double width, double height, std::string_view title) {
    body_ = "<svg viewBox=\"0 0 " + short_number(width, 1) + ' ' + short_number(height, 1) +
            "\" role=\"img\"><title>" + escaped(title) + "</title>";
}

void Svg::line(double x1, double y1, double x2, double y2, std::string_view classes) {
    body_ += "<line" + class_attribute(classes) + attribute("x1", x1) + attribute("y1", y1) +
             attribute("x2", x2) + attribute("y2", y2) + "/>";
}

void Svg::rect(double x, double y, double width, double height, std::string_view classes,
               std::string_view tip) {
    body_ += "<rect" + class_attribute(classes) + attribute("x", x) + attribute("y", y) +
             attribute("width", width) + attribute("height", height) + closed("rect", tip);
}

void Svg::circle(double x, double y, double radius, std::string_view classes,
                 std::string_view tip) {
    body_ += "<circle" + class_attribute(classes) + attribute("cx", x) + attribute("cy", y) +
             attribute("r", radius) + closed("circle", tip);
}

void Svg::text(double x, double y, std::string_view text, std::string_view classes) {
    body_ += "<text" + class_attribute(classes) + attribute("x", x) + attribute("y", y) + '>' +
             escaped(text) + "</text>";
}

void Svg::path(const std::string& data, std::string_view classes) {
    if (data.empty()) return;
    body_ += "<path" + class_attribute(classes) + " d=\"" + data + "\"/>";
}

std::string Svg::finish() const {
    return body_ + "</svg>\n";
}

std::string bar_chart(std::string_view title, const std::vector<double>& values,
                      const std::vector<std::string>& labels, std::string_view x_name) {
    Svg svg(kWidth, kHeight, title);
    const double largest = values.empty() ? 1.0 : std::max(std::ranges::max(values), 1e-9);
    horizontal_grid(svg, largest);
    const double step = kPlotWidth / static_cast<double>(std::max<std::size_t>(values.size(), 1));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double height = kPlotHeight * values[i] / largest;
        const double x = kLeft + step * static_cast<double>(i);
        const std::string label = i < labels.size() ? labels[i] : std::string();
        svg.rect(x + 0.5, kTop + kPlotHeight - height, std::max(step - 1.0, 0.5), height, "bar",
                 short_number(values[i], 2));
        if (!label.empty()) svg.text(x + step / 2, kTop + kPlotHeight + 15, label, "middle");
    }
    svg.text(kLeft + kPlotWidth / 2, kHeight - 6, x_name, "middle");
    return svg.finish();
}

std::string line_chart(std::string_view title, const std::vector<Series>& series,
                       std::string_view x_name) {
    double largest_x = 1e-9, largest_y = 1e-9;
    for (const Series& one : series) {
        for (const auto& [x, y] : one.points) {
            largest_x = std::max(largest_x, x);
            largest_y = std::max(largest_y, y);
        }
    }
    Svg svg(kWidth, kHeight, title);
    horizontal_grid(svg, largest_y);
    const double x_step = round_step(largest_x);
    for (double mark = 0.0; mark <= largest_x * 1.0001; mark += x_step) {
        svg.text(kLeft + kPlotWidth * mark / largest_x, kTop + kPlotHeight + 15,
                 short_number(mark, 2), "middle");
    }
    double legend = kLeft + 10;
    for (const Series& one : series) {
        std::string data;
        for (const auto& [x, y] : one.points) {
            data += data.empty() ? 'M' : 'L';
            data += short_number(kLeft + kPlotWidth * x / largest_x, 1) + ' ' +
                    short_number(kTop + kPlotHeight * (1.0 - y / largest_y), 1);
        }
        svg.path(data, "curve " + one.classes);
        svg.line(legend, kTop + 8, legend + 18, kTop + 8, "curve " + one.classes);
        svg.text(legend + 23, kTop + 12, one.name);
        legend += 40 + 7.0 * static_cast<double>(one.name.size());
    }
    svg.text(kLeft + kPlotWidth / 2, kHeight - 6, x_name, "middle");
    return svg.finish();
}

}  // namespace psfm
