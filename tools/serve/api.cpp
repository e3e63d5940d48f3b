// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/api.h"

#include <algorithm>
#include <charconv>
#include <ctime>
#include <nlohmann/json.hpp>

#include "storage/exchange/files/json_text.h"
#include "tools/serve/gzip.h"
#include "tools/serve/pages.h"
#include "tools/serve/uploads/sha256.h"
#include "tools/serve/view_page.h"

namespace psfm {
namespace {

constexpr std::string_view kApi = "/api/v1";
constexpr std::string_view kCookie = "psfm_token";
constexpr std::size_t kMostJson = 4096;  // Guard: of a body: a token

bool takes_gzip(const HttpRequest& request) {
    return request.header("accept-encoding").find("gzip") != std::string_view::npos;
}

HttpResponse content(std::string_view type, std::shared_ptr<const std::string> plain,
                     std::shared_ptr<const std::string> gzip, const HttpRequest& request) {
    HttpResponse response;
    response.headers = {{"Content-Type", std::string(type)}, {"Cache-Control", "no-cache"}};
    if (gzip && takes_gzip(request)) {
        response.headers.emplace_back("Content-Encoding", "gzip");
        response.headers.emplace_back("Vary", "Accept-Encoding");
        response.body = std::move(gzip);
    } else {
        response.body = std::move(plain);
    }
    return response;
}

std::string cookie_of(std::string_view cookies, std::string_view name) {
    while (!cookies.empty()) {
        std::string_view one = cookies.substr(0, cookies.find(';'));
        cookies.remove_prefix(std::min(cookies.size(), one.size() + 1));
        while (one.starts_with(' ')) one.remove_prefix(1);
        if (one.starts_with(name) && one.substr(name.size()).starts_with('='))
            return std::string(one.substr(name.size() + 1));
    }
    return {};
}

std::string token_of(const HttpRequest& request) {
    constexpr std::string_view kBearer = "Bearer ";
    const std::string_view authorization = request.header("authorization");
    if (authorization.starts_with(kBearer))
        return std::string(authorization.substr(kBearer.size()));
    return cookie_of(request.header("cookie"), kCookie);
}

/// What may stand in a cookie: the letters of URL-safe base64.
bool is_token(std::string_view text) {
    constexpr std::size_t kLongest = 128;  // Guard: of what is hashed and sent back; ours have 43
    constexpr std::string_view kLetters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
    return !text.empty() && text.size() <= kLongest &&
           text.find_first_not_of(kLetters) == std::string_view::npos;
}

bool is_of_photographs(std::string_view path) {
    if (!path.starts_with(kApi)) return false;
    path.remove_prefix(kApi.size());
    return path == "/photographs" || path.starts_with("/photographs/");
}

}  // namespace

/// Requests that other sites make a browser send, and names that somebody else has given to this
/// address, are nobody's.
std::optional<HttpResponse> Api::stranger(const HttpRequest& head) const {
    const std::string host = small_letters(head.header("host"));
    const std::string name =
        host.ends_with(']')
            ? host
            : host.substr(0, host.rfind(':') == std::string::npos ? host.size() : host.rfind(':'));
    if (!parts_.hosts.contains(host) && !parts_.hosts.contains(name))
        return problem(421, "this server is not called " + host + "; --host names it");
    const std::string_view site = head.header("sec-fetch-site");
    const bool is_foreign = !site.empty() && site != "same-origin" && site != "none";
    const bool is_reading = head.method == "GET" || head.method == "HEAD";
    if (is_foreign && (!is_reading || head.path.starts_with(kApi)))
        return problem(403, "requests of other sites are not answered");
    const std::string origin = small_letters(head.header("origin"));
    if (!origin.empty() && origin != "http://" + host && origin != "https://" + host)
        return problem(403, "requests of other sites are not answered");
    if (!head.header("content-encoding").empty() && head.header("content-encoding") != "identity")
        return problem(415, "compressed requests are not read");
    return std::nullopt;
}

bool Api::is_open() const {
    return parts_.users == nullptr || (parts_.is_loopback && !parts_.users->had_any());
}

std::optional<User> Api::caller_of(const HttpRequest& head) const {
    // Where nobody may send, pages have to know it before they ask.
    if (is_open() && parts_.uploads == nullptr)
        return User{0, "anyone", UserRole::kLook, {}, 0, false, 0};
    if (is_open()) return User{0, "owner", UserRole::kOwner, {}, 0, false, 0};
    const std::string token = token_of(head);
    return token.empty() ? std::nullopt : parts_.users->of_token(token);
}

std::function<bool()> Api::still_holds(const User& user) const {
    return [this, number = user.number] { return is_open() || parts_.users->is_valid(number); };
}

HttpResponse Api::refuse_caller(const HttpRequest& head, const std::string& why) {
    constexpr int kFailuresAMinute = 10;  // Guard: of an address that tries tokens
    if (!token_of(head).empty()) {
        const std::lock_guard lock(mutex_);
        const std::int64_t minute = std::time(nullptr) / 60;
        std::erase_if(failures_, [&](const auto& entry) { return entry.second.minute != minute; });
        Failures& failures = failures_[head.address];
        failures.minute = minute;
        if (++failures.count > kFailuresAMinute) {
            HttpResponse response = problem(429, "too many wrong tokens from this address");
            response.headers.emplace_back("Retry-After", "60");
            return response;
        }
    }
    HttpResponse response = problem(401, why);
    response.headers.emplace_back("WWW-Authenticate", "Bearer");
    return response;
}

HttpPlan Api::plan(const HttpRequest& head) {
    HttpPlan plan = plan_api(head);
    if (is_of_photographs(head.path)) plan.headers = {{"Tus-Resumable", "1.0.0"}};
    return plan;
}

HttpPlan Api::plan_api(const HttpRequest& head) {
    if (auto refusal = stranger(head)) return at_once(*std::move(refusal));
    if (!head.path.starts_with(std::string(kApi) + "/")) return plan_page(head);
    const std::string path = head.path.substr(kApi.size());
    if (path == "/login") return plan_login(head);
    const auto caller = caller_of(head);
    if (!caller) return at_once(refuse_caller(head, "this wants the link that you were given"));
    HttpPlan plan =
        is_of_photographs(head.path) ? plan_photograph(head, *caller) : plan_read(head, *caller);
    plan.may_go_on = still_holds(*caller);
    return plan;
}

HttpPlan Api::plan_page(const HttpRequest& head) const {
    if (head.method != "GET" && head.method != "HEAD")
        return at_once(problem(405, "pages are only read"));
    if (!has_pages()) {
        return at_once(problem(404, "this psfm was built without pages; the API is under /api/v1"));
    }
    const auto text = [&](std::string_view type, std::string body) {
        auto plain = std::make_shared<const std::string>(std::move(body));
        auto gzip =
            takes_gzip(head) ? std::make_shared<const std::string>(gzipped(*plain)) : nullptr;
        return content(type, plain, gzip, head);
    };
    const std::string path = head.path;
    if (path == "/")
        return by_work([=](const HttpRequest&) {
            return text("text/html; charset=utf-8", served_page("psfm", "viewer.js"));
        });
    if (path == "/capture") {
        return by_work([=](const HttpRequest&) {
            return text("text/html; charset=utf-8",
                        served_page("psfm: send photographs", "capture.js"));
        });
    }
    if (path == "/viewer.js" || path == "/capture.js") {
        return by_work([=](const HttpRequest&) {
            return text("text/javascript; charset=utf-8", std::string(page_file(path.substr(1))));
        });
    }
    if (path == "/style.css")
        return by_work([=](const HttpRequest&) {
            return text("text/css; charset=utf-8", std::string(page_file("style.css")));
        });
    if (path == "/favicon.ico") {  // browsers ask for it, and there is none
        HttpResponse none;
        none.status = 204;
        none.headers = {{"Cache-Control", "max-age=86400"}};
        return at_once(std::move(none));
    }
    return at_once(problem(404, "there is nothing here"));
}

HttpPlan Api::plan_login(const HttpRequest& head) {
    const std::string attributes =
        "; Path=/; HttpOnly; SameSite=Strict" +
        std::string(head.header("x-forwarded-proto") == "https" ? "; Secure" : "");
    if (head.method == "DELETE") {
        HttpResponse response;
        response.status = 204;
        response.headers = {{"Set-Cookie", std::string(kCookie) + "=; Max-Age=0" + attributes}};
        return at_once(std::move(response));
    }
    if (head.method != "POST") return at_once(problem(405, "POST signs in, DELETE signs out"));
    if (!head.header("content-type").starts_with("application/json"))
        return at_once(problem(415, "application/json with a token is wanted"));
    HttpPlan plan;
    plan.most_body = kMostJson;
    plan.work = [this, attributes](const HttpRequest& request) {
        const auto object = parse_json(request.body);
        if (!object.is_object() || !object.contains("token") || !object["token"].is_string())
            return problem(400, "a token is wanted");
        const auto token = object["token"].get<std::string>();
        if (!is_token(token))
            return problem(400, "a token has 1 to 128 letters, digits, '-' and '_'");
        HttpRequest with_token = request;
        with_token.headers["authorization"] = "Bearer " + token;
        const auto caller = caller_of(with_token);
        if (!caller) return refuse_caller(with_token, "the link has expired, or was never one");
        HttpResponse response =
            json_response(200, json_text(nlohmann::ordered_json{
                                   {"name", caller->name}, {"role", role_name(caller->role)}}));
        if (is_open()) return response;  // whoever comes needs none
        response.headers.emplace_back(
            "Set-Cookie", std::string(kCookie) + "=" + token + "; Max-Age=31536000" + attributes);
        return response;
    };
    return plan;
}

}  // namespace psfm
