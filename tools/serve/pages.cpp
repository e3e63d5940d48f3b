// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The files that tools/viewer/CMakeLists.txt has made, put into the program by the assembler.
#include "tools/serve/pages.h"

#ifdef PSFM_PAGES

#define PSFM_EMBED(symbol, file)                                                          \
    asm(".section .rodata\n.balign 16\n.global psfm_page_" #symbol "\npsfm_page_" #symbol \
        ":\n.incbin \"" PSFM_PAGES "/" file "\"\n.global psfm_page_" #symbol              \
        "_end\npsfm_page_" #symbol "_end:\n.byte 0\n.previous\n");                        \
    extern "C" const char psfm_page_##symbol[];                                           \
    extern "C" const char psfm_page_##symbol##_end[]

PSFM_EMBED(viewer, "viewer.js");
PSFM_EMBED(capture, "capture.js");
PSFM_EMBED(style, "style.css");
PSFM_EMBED(three, "three.LICENSE");

namespace psfm {

bool has_pages() {
    return true;
}

std::string_view page_file(std::string_view name) {
    const auto between = [](const char* begin, const char* end) {
        return std::string_view(begin, static_cast<std::size_t>(end - begin));
    };
    if (name == "viewer.js") return between(psfm_page_viewer, psfm_page_viewer_end);
    if (name == "capture.js") return between(psfm_page_capture, psfm_page_capture_end);
    if (name == "style.css") return between(psfm_page_style, psfm_page_style_end);
    if (name == "three.LICENSE") return between(psfm_page_three, psfm_page_three_end);
    return {};
}

}  // namespace psfm

#else

namespace psfm {

bool has_pages() {
    return false;
}

std::string_view page_file(std::string_view /*name*/) {
    return {};
}

}  // namespace psfm

#endif
