// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/http.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "storage/exchange/files/json_text.h"

namespace psfm {
namespace {

int digit_of(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::optional<std::string> decoded(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            out += text[i];
            continue;
        }
        if (i + 2 >= text.size()) return std::nullopt;
        const int high = digit_of(text[i + 1]);
        const int low = digit_of(text[i + 2]);
        if (high < 0 || low < 0) return std::nullopt;
        out += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return out;
}

bool is_plain(std::string_view text) {
    for (const char c : text) {
        if (static_cast<unsigned char>(c) <= 0x20 || static_cast<unsigned char>(c) >= 0x7f)
            return false;
    }
    return true;
}

}  // namespace

std::string_view status_text(unsigned status) {
    static const std::map<unsigned, std::string_view> kTexts{
        {200, "OK"},
        {201, "Created"},
        {204, "No Content"},
        {304, "Not Modified"},
        {400, "Bad Request"},
        {401, "Unauthorized"},
        {403, "Forbidden"},
        {404, "Not Found"},
        {405, "Method Not Allowed"},
        {408, "Request Timeout"},
        {409, "Conflict"},
        {410, "Gone"},
        {411, "Length Required"},
        {413, "Content Too Large"},
        {415, "Unsupported Media Type"},
        {421, "Misdirected Request"},
        {422, "Unprocessable Content"},
        {423, "Locked"},
        {429, "Too Many Requests"},
        {431, "Request Header Fields Too Large"},
        {500, "Internal Server Error"},
        {503, "Service Unavailable"},
        {507, "Insufficient Storage"}};
    const auto found = kTexts.find(status);
    return found == kTexts.end() ? std::string_view("Unknown") : found->second;
}

std::string small_letters(std::string_view text) {
    std::string small(text);
    for (char& c : small) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return small;
}

bool may_have_body(const HttpResponse& response) {
    return response.status != 204 && response.status != 304;
}

std::string head_text(const HttpResponse& response, std::optional<std::uint64_t> length,
                      bool keep_alive) {
    std::string head = "HTTP/1.1 " + std::to_string(response.status) + ' ' +
                       std::string(status_text(response.status)) + "\r\n";
    for (const auto& [name, value] : response.headers) head += name + ": " + value + "\r\n";
    if (length && may_have_body(response))
        head += "Content-Length: " + std::to_string(*length) + "\r\n";
    head += keep_alive ? "\r\n" : "Connection: close\r\n\r\n";
    return head;
}

HttpResponse problem(unsigned status, const std::string& detail) {
    const nlohmann::ordered_json object{{"type", "about:blank"},
                                        {"title", status_text(status)},
                                        {"status", status},
                                        {"detail", detail}};
    HttpResponse response;
    response.status = status;
    response.headers = {{"Content-Type", "application/problem+json"},
                        {"Cache-Control", "no-store"}};
    response.body = std::make_shared<const std::string>(json_text(object) + "\n");
    return response;
}

HttpResponse json_response(unsigned status, std::string body) {
    HttpResponse response;
    response.status = status;
    response.headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}};
    response.body = std::make_shared<const std::string>(std::move(body));
    return response;
}

void add_security_headers(HttpResponse& response) {
    response.headers.insert(
        response.headers.end(),
        {{"Content-Security-Policy",
          "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
          "connect-src 'self'; worker-src 'self'; frame-ancestors 'none'; base-uri 'none'; "
          "form-action 'none'"},
         {"X-Content-Type-Options", "nosniff"},
         {"Referrer-Policy", "no-referrer"},
         {"Cross-Origin-Opener-Policy", "same-origin"},
         {"Cross-Origin-Resource-Policy", "same-origin"}});
}

std::optional<std::uint64_t> number_in(std::string_view text) {
    std::uint64_t number = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    if (text.empty() || parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
        return std::nullopt;
    return number;
}

std::vector<std::string> parts_of(const std::string& path) {
    std::vector<std::string> parts;
    std::istringstream stream(path);
    std::string part;
    while (std::getline(stream, part, '/')) parts.push_back(part);
    return parts;
}

bool add_header(std::string_view name, std::string_view value, HttpRequest& request) {
    static const std::set<std::string> kOnce{"host",          "authorization", "origin",
                                             "upload-offset", "upload-length", "content-type"};
    const std::string small = small_letters(name);
    const auto [known, is_new] = request.headers.emplace(small, std::string(value));
    if (is_new) return true;
    if (kOnce.contains(small)) return false;
    known->second.append(", ").append(value);
    return true;
}

bool parse_target(std::string_view target, HttpRequest& request) {
    if (target.empty() || target.front() != '/' || !is_plain(target)) return false;
    const std::size_t mark = target.find('?');
    const auto path = decoded(target.substr(0, mark));
    if (!path || path->find('\0') != std::string::npos) return false;
    request.path = *path;
    if (mark == std::string_view::npos) return true;
    std::string_view rest = target.substr(mark + 1);
    while (!rest.empty()) {
        const std::string_view item = rest.substr(0, rest.find('&'));
        rest.remove_prefix(std::min(rest.size(), item.size() + 1));
        const std::size_t equals = item.find('=');
        const auto name = decoded(item.substr(0, equals));
        const auto value = decoded(equals == std::string_view::npos ? std::string_view()
                                                                    : item.substr(equals + 1));
        if (!name || !value) return false;
        request.query[*name] = *value;
    }
    return true;
}

}  // namespace psfm
