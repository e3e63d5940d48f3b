// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/session/option_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "scheduler/session/named_options.h"

namespace psfm {
namespace {

/// All of them, by name.
const std::vector<NamedOption>& table() {
    static const std::vector<NamedOption> kTable = [] {
        std::vector<NamedOption> options;
        for (const auto part :
             {options_of_photographs_and_pairs(), options_of_solving(), options_of_merging()})
            options.insert(options.end(), part.begin(), part.end());
        std::ranges::sort(options, {}, &NamedOption::name);
        return options;
    }();
    return kTable;
}

/// An option that is no more, in sessions of earlier programs and in scripts: what it was is
/// another one now.
struct Retired {
    std::string_view name, now;
    /// Sets the other one from its value, once all others are set; null: it cannot be told.
    void (*take_over)(StageOptions& options, double value) = nullptr;
    double low = 0.0;  ///< least value that it had
};

void hold_from(StageOptions& options, double images) {
    ClusteringOptions& clustering = options.clustering;
    constexpr double kLeast = 1e-6;  // Guard: the option's range
    if (clustering.join_up_to > 0)
        clustering.hold_part = std::clamp(images / clustering.join_up_to, kLeast, 1.0);
}

/// Format: names and ranges as they were released.
constexpr std::array kRetired{
    Retired{"clustering.hold_from", "clustering.hold_part", &hold_from, 2},
    Retired{"solve.policy.places.whole_up_to", "solve.policy.affordable_up_to"}};

const Retired* find_retired(std::string_view name) {
    const auto* found = std::ranges::find(kRetired, name, &Retired::name);
    return found == kRetired.end() ? nullptr : found;
}

const NamedOption* find(std::string_view name) {
    const auto found = std::ranges::lower_bound(table(), name, {}, &NamedOption::name);
    return found != table().end() && found->name == name ? &*found : nullptr;
}

/// Names that end as the asked one does, to show what may have been meant.
std::string alike(std::string_view name) {
    const std::string_view field = name.substr(name.rfind('.') + 1);
    std::string names;
    for (const NamedOption& option : table()) {
        if (option.name.find(field) == std::string_view::npos) continue;
        names += (names.empty() ? "" : ", ") + std::string(option.name);
    }
    return names;
}

Error unknown(const std::string& name) {
    if (const Retired* retired = find_retired(name)) {
        return {ErrorCode::kInvalidArgument, "the option '" + name + "' is no more; " +
                                                 std::string(retired->now) +
                                                 " decides what it decided"};
    }
    const std::string names = alike(name);
    return {ErrorCode::kInvalidArgument,
            "there is no option '" + name + "'" +
                (names.empty() ? "; `psfm options` lists them" : "; did you mean " + names + "?")};
}

std::string text(double value) {
    char buffer[32];
    const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
    return {buffer, end};
}

}  // namespace

std::span<const NamedOption> option_table() {
    return table();
}

std::map<std::string, double> option_values(const StageOptions& options) {
    std::map<std::string, double> values;
    for (const NamedOption& option : table()) values.emplace(option.name, option.get(options));
    return values;
}

Result<void> set_options(StageOptions& options, const std::map<std::string, double>& values) {
    const auto check = [](const std::string& name, double value, double low,
                          double high) -> Result<void> {
        if (value >= low && value <= high) return {};
        return Error{
            ErrorCode::kInvalidArgument,
            name + " is " + text(value) + "; give a value from " + text(low) + " to " + text(high)};
    };
    for (const auto& [name, value] : values) {
        const NamedOption* option = find(name);
        if (option == nullptr && find_retired(name) != nullptr) continue;  // below
        if (option == nullptr) return unknown(name);
        if (const auto fits = check(name, value, option->low, option->high); !fits.ok())
            return fits.error();
        option->set(options, value);
    }
    for (const Retired& retired : kRetired) {
        const auto set = values.find(std::string(retired.name));
        if (set == values.end() || values.contains(std::string(retired.now))) continue;
        if (retired.take_over == nullptr) continue;
        if (const auto fits = check(set->first, set->second, retired.low, kCount); !fits.ok())
            return fits.error();
        retired.take_over(options, set->second);
    }
    return {};
}

Result<std::pair<std::string, double>> parse_setting(const std::string& text) {
    const std::size_t sign = text.find('=');
    const std::string name = text.substr(0, sign);
    if (sign == std::string::npos)
        return Error{ErrorCode::kInvalidArgument, "'" + text + "' is not of the form NAME=VALUE"};
    const Retired* retired = find_retired(name);
    const bool is_known =
        find(name) != nullptr || (retired != nullptr && retired->take_over != nullptr);
    if (!is_known) return unknown(name);
    double value = 0.0;
    const char* end = text.data() + text.size();
    const auto [parsed, error] = std::from_chars(text.data() + sign + 1, end, value);
    if (error != std::errc{} || parsed != end)
        return Error{ErrorCode::kInvalidArgument,
                     name + " wants a number, not '" + text.substr(sign + 1) + "'"};
    return std::pair(name, value);
}

}  // namespace psfm
