// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/view_page.h"

#include "tools/report/svg.h"
#include "tools/serve/gzip.h"
#include "tools/serve/pages.h"
#include "tools/serve/uploads/sha256.h"

namespace psfm {
namespace {

std::string source_hash(std::string_view text) {
    std::string hash = "'sha256-";
    hash.append(base64(sha256_bytes(text))).push_back('\'');
    return hash;
}

std::string block(const std::string& id, const std::string& bytes) {
    if (bytes.empty()) return "<script type=\"application/gzip\" id=\"" + id + "\"></script>\n";
    return "<script type=\"application/gzip\" id=\"" + id + "\">" + base64(gzipped(bytes)) +
           "</script>\n";
}

std::string head(std::string_view title) {
    return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
           "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
           escaped(title) + "</title>\n";
}

}  // namespace

std::string view_page(const ViewPageData& data) {
    // Inside of a script element nothing ends it but this; the bundle has none of its own.
    std::string script(page_file("viewer.js"));
    for (std::size_t at = script.find("</script"); at != std::string::npos;
         at = script.find("</script", at))
        script.replace(at, 2, "<\\/");
    const std::string style(page_file("style.css"));
    std::string page = head(data.title);
    page +=
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src " +
        source_hash(script) + "; style-src 'unsafe-inline'; img-src data: blob:; base-uri " +
        "'none'; form-action 'none'\">\n";
    page += "<style>" + style + "</style></head><body><div id=\"app\"></div>\n";
    page += block("session", data.session) + block("scene", data.scene) +
            block("replay", data.replay) + block("tracks", data.tracks);
    page += "<script>" + script + "</script></body></html>\n";
    return page;
}

std::string served_page(std::string_view title, std::string_view script) {
    std::string page = head(title);
    page +=
        "<link rel=\"stylesheet\" href=\"/style.css\"></head><body><div id=\"app\"></div>"
        "<script src=\"/";
    page.append(script);
    page += "\"></script></body></html>\n";
    return page;
}

}  // namespace psfm
