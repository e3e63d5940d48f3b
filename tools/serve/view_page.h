// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace psfm {

/// What a page in one file holds, uncompressed.
struct ViewPageData {
    std::string title;
    std::string session;  ///< session_json
    std::string scene;    ///< a change from nothing
    std::string replay;   ///< replay_bytes
    std::string tracks;   ///< tracks_bytes
};

/// The viewer and a session as one HTML file that needs no network: its policy lets nothing else in
/// than its own script. REQUIRES: has_pages()
std::string view_page(const ViewPageData& data);

/// The viewer's or the capture page's HTML as a server sends it, with its script beside it.
/// @param script  "viewer.js" or "capture.js"
std::string served_page(std::string_view title, std::string_view script);

}  // namespace psfm
