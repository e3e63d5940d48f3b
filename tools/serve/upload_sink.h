// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "tools/serve/upload_store.h"

namespace psfm {

/// An answer that says how much of a photograph is here.
HttpResponse offset_answer(unsigned status, std::uint64_t offset);

/// Bytes of one request, onto the end of the part file.
class UploadSink final : public BodySink {
  public:
    /// @param store  outlives this; @param part  where the bytes go
    UploadSink(UploadStore& store, UploadStore::Offer offer, std::filesystem::path part);
    ~UploadSink() override { end(); }
    UploadSink(const UploadSink&) = delete;
    UploadSink& operator=(const UploadSink&) = delete;

    std::optional<HttpResponse> write(std::string_view bytes) override;
    HttpResponse finish() override;
    void give_up() override { end(); }

  private:
    HttpResponse stop(HttpResponse response);
    void end();

    UploadStore* store_;
    UploadStore::Offer offer_;
    std::filesystem::path part_;
    std::uint64_t at_;
    int descriptor_ = -1;
    bool ended_ = false;
};

}  // namespace psfm
