// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/uploads/sent_photographs.h"

#include <fstream>
#include <nlohmann/json.hpp>

namespace psfm {

SentPhotographs::SentPhotographs(const std::filesystem::path& session)
    : log_(session / "uploads.log") {}

std::optional<PhotographOrigin> SentPhotographs::operator()(const std::string& name) {
    std::error_code error;  // Expected: a session that was never served has none
    const auto size = std::filesystem::file_size(log_, error);
    if (!error && size != read_) {
        read_ = size;
        std::ifstream stream(log_);
        for (std::string line; std::getline(stream, line);) {
            const auto said = nlohmann::json::parse(line, nullptr, false);
            if (!said.is_object() || !said.contains("file")) continue;  // broken off, or a removal
            try {
                by_name_.try_emplace(said["file"].get<std::string>(),
                                     PhotographOrigin{said.at("name").get<std::string>(),
                                                      said.at("user").get<std::uint32_t>(),
                                                      said.at("sha256").get<std::string>()});
            } catch (const nlohmann::json::exception&) {
                continue;
            }
        }
    }
    const auto known = by_name_.find(name);
    return known == by_name_.end() ? std::nullopt : std::optional(known->second);
}

}  // namespace psfm
