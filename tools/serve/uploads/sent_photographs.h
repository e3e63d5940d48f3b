// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <system_error>

#include "tools/report/image_facts.h"
#include "tools/serve/uploads/sent_book.h"

namespace psfm {

/// What users have sent to a session, for who only reads it: SESSION/uploads.log, read again
/// whenever it has grown. An OriginOf; one thread at a time.
class SentPhotographs {
  public:
    explicit SentPhotographs(const std::filesystem::path& session)
        : log_(session / "uploads.log") {}

    /// Whether they have sent any, those included that were removed since.
    bool has_any() const {
        std::error_code unknown;
        return std::filesystem::exists(log_, unknown) || unknown;
    }

    std::optional<PhotographOrigin> operator()(const std::string& name);

  private:
    std::filesystem::path log_;
    std::uintmax_t read_ = 0;  // bytes
    SentBook book_;
};

std::optional<PhotographOrigin> origin_in(const SentBook& book, const std::string& name);

}  // namespace psfm
