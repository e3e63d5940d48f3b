// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session/installed_vocabulary.h"

#include <cstdlib>
#include <optional>
#include <system_error>

namespace psfm {
namespace {

constexpr const char* kOfMachine = "/usr/local/share/psfm/vocabulary";  // Format: as documented

std::optional<std::string> environment(const char* name) {
    const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nobody sets it
    if (value == nullptr) return std::nullopt;
    return value;
}

}  // namespace

std::filesystem::path vocabulary_of_user() {
    if (const auto named = environment("PSFM_VOCABULARY")) return *named;
    const auto data = environment("XDG_DATA_HOME");
    if (data && !data->empty()) return std::filesystem::path(*data) / "psfm" / "vocabulary";
    const auto home = environment("HOME");
    if (!home || home->empty()) return {};
    return std::filesystem::path(*home) / ".local" / "share" / "psfm" / "vocabulary";
}

std::string installed_vocabulary() {
    const std::filesystem::path own = vocabulary_of_user();
    std::error_code ignored;  // Expected: what cannot be looked at is not used
    if (!own.empty() && std::filesystem::exists(own, ignored))
        return std::filesystem::absolute(own).string();
    const bool is_off = environment("PSFM_VOCABULARY").has_value();
    if (!is_off && std::filesystem::exists(kOfMachine, ignored)) return kOfMachine;
    return {};
}

}  // namespace psfm
