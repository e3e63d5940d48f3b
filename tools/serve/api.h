// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "tools/serve/http.h"
#include "tools/serve/live_session.h"
#include "tools/serve/upload_store.h"
#include "tools/serve/users.h"

namespace psfm {

struct ApiParts {
    const SessionReader* reader = nullptr;
    LiveSession* live = nullptr;
    UploadStore* uploads = nullptr;  ///< null: nobody may send
    Users* users = nullptr;          ///< null: whoever comes may look (read-only, loopback)
    std::filesystem::path session;
    /// What a request's Host may be, in small letters: "NAME:PORT", or "NAME" for every port.
    std::set<std::string> hosts;
    /// Makes a small JPEG of a photograph, in a process that is held down. Empty: no thumbnails.
    std::function<std::optional<std::string>(const std::filesystem::path&)> thumbnail;
    bool is_loopback = true;  ///< else nobody is the owner without a token, ever
};

/// The pages and /api/v1 (docs/openapi.json, docs/serve.md): who may ask for what.
class Api final : public HttpApplication {
  public:
    explicit Api(ApiParts parts) : parts_(std::move(parts)) {}
    HttpPlan plan(const HttpRequest& head) override;

  private:
    std::optional<HttpResponse> stranger(const HttpRequest& head) const;
    /// @return nothing: he has no token that holds
    std::optional<User> caller_of(const HttpRequest& head) const;
    /// The answer to a caller who is nobody; counts what he has tried.
    HttpResponse refuse_caller(const HttpRequest& head, const std::string& why);
    /// Whoever comes is the owner, or may look where nobody may send.
    bool is_open() const;
    /// Asked while a request lasts: whether its caller may still do what it does.
    std::function<bool()> still_holds(const User& user) const;
    HttpPlan plan_api(const HttpRequest& head);
    HttpPlan plan_page(const HttpRequest& head) const;
    HttpPlan plan_login(const HttpRequest& head);
    HttpPlan plan_read(const HttpRequest& head, const User& user);
    HttpPlan plan_photograph(const HttpRequest& head, const User& user);

    HttpResponse session(const User& user, const HttpRequest& request) const;
    HttpResponse scene(const HttpRequest& request) const;
    HttpResponse changes(const HttpRequest& request) const;
    HttpResponse replay(const HttpRequest& request);
    HttpResponse point(std::uint32_t cluster, std::uint32_t slot) const;
    HttpResponse image(std::uint32_t image) const;
    HttpResponse pair(std::uint32_t first, std::uint32_t second) const;
    HttpResponse thumbnail(std::uint32_t image) const;
    HttpResponse mine(const User& user) const;

    ApiParts parts_;
    std::mutex mutex_;  // of what follows
    struct Failures {
        std::int64_t minute = 0;
        int count = 0;
    };
    std::map<std::string, Failures> failures_;  // by address
    // Of the lane of models:
    std::uint64_t replay_version_ = 0;
    std::shared_ptr<const std::string> replay_, replay_gzip_;
};

}  // namespace psfm
