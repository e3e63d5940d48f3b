// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/uploads/sent_photographs.h"

namespace psfm {

std::optional<PhotographOrigin> SentPhotographs::operator()(const std::string& name) {
    std::error_code error;  // Expected: a session that was never served has none
    const auto size = std::filesystem::file_size(log_, error);
    if (!error && size != read_) {
        read_ = size;
        book_ = SentBook::read(log_);
    }
    return origin_in(book_, name);
}

std::optional<PhotographOrigin> origin_in(const SentBook& book, const std::string& name) {
    const Upload* const upload = book.find_file(name);
    if (upload == nullptr) return std::nullopt;
    return PhotographOrigin{upload->title, upload->user, upload->sha256};
}

}  // namespace psfm
