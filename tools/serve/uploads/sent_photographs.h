// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "tools/report/image_facts.h"

namespace psfm {

/// What users have sent to a session, for who only reads it: SESSION/uploads.log, read again
/// whenever it has grown. One thread at a time.
class SentPhotographs {
  public:
    explicit SentPhotographs(const std::filesystem::path& session);

    std::optional<PhotographOrigin> operator()(const std::string& name);

  private:
    std::filesystem::path log_;
    std::uintmax_t read_ = 0;  // bytes
    std::map<std::string, PhotographOrigin> by_name_;
};

}  // namespace psfm
