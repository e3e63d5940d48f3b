// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Photographs that are sent to a session.
#include <map>
#include <nlohmann/json.hpp>

#include "storage/exchange/files/json_text.h"
#include "tools/serve/api.h"
#include "tools/serve/uploads/sha256.h"
#include "tools/serve/uploads/title.h"

namespace psfm {

using nlohmann::ordered_json;

HttpPlan Api::plan_photograph(const HttpRequest& head, const User& user) {
    if (parts_.uploads == nullptr) return at_once(problem(404, "this server takes no photographs"));
    if (user.role == UserRole::kLook)
        return at_once(problem(403, "your link is for looking; ask for one to send"));
    const auto parts = parts_of(head.path);
    if (parts.size() == 4) {
        if (head.method != "GET" && head.method != "HEAD")
            return at_once(problem(405, "the list of your photographs is only read"));
        return by_work([this, user](const HttpRequest&) { return mine(user); });
    }
    if (parts.size() != 5 || !is_sha256(parts[4]))
        return at_once(problem(404, "a photograph is called by its SHA-256, in small letters"));
    const std::string& sha256 = parts[4];
    if (head.method == "HEAD") {
        const auto progress = parts_.uploads->progress(user.number, sha256);
        if (!progress.complete && progress.offset == 0)
            return at_once(problem(404, "nothing of this photograph is here"));
        HttpResponse response;
        response.length = 0;
        response.headers = {{"Upload-Offset", std::to_string(progress.offset)},
                            {"Upload-Length", std::to_string(progress.length)},
                            {"Cache-Control", "no-store"}};
        return at_once(std::move(response));
    }
    if (head.method == "DELETE") {
        return by_work(
            [this, user, sha256](const HttpRequest&) {
                return parts_.uploads->remove(user.number, sha256, user.role == UserRole::kOwner);
            },
            Lane::kModel);
    }
    const auto name = head.query.find("name");
    std::string title = title_of(name == head.query.end() ? std::string() : name->second);
    constexpr std::size_t kOfHash = 12;  // Guard: tells a session's photographs from each other
    if (title.empty()) title = sha256.substr(0, kOfHash);
    UploadStore::Offer offer{user.number, sha256, std::move(title), 0, std::nullopt, false};
    if (head.method == "PUT") {
        if (!head.has_length) return at_once(problem(411, "Content-Length is wanted"));
        offer.length = head.content_length;
        offer.anew = true;
    } else if (head.method == "PATCH") {
        if (!head.header("content-type").starts_with("application/offset+octet-stream"))
            return at_once(problem(415, "application/offset+octet-stream is wanted"));
        const auto offset = number_in(head.header("upload-offset"));
        if (!offset) return at_once(problem(400, "Upload-Offset is wanted"));
        offer.offset = *offset;
        offer.length = number_in(head.header("upload-length"));
        if (!offer.length && !head.header("upload-length").empty())
            return at_once(problem(400, "Upload-Length is a number of bytes"));
    } else {
        return at_once(problem(405, "HEAD, PATCH, PUT and DELETE are what a photograph takes"));
    }
    UploadStore::Admission admission = parts_.uploads->admit(offer);
    if (admission.refusal) return at_once(*std::move(admission.refusal));
    HttpPlan plan;
    plan.sink = std::move(admission.sink);
    plan.most_body = static_cast<std::size_t>(admission.most_body);
    return plan;
}

HttpResponse Api::mine(const User& user) const {
    std::map<std::string, ImageFact> by_name;
    for (ImageFact& fact : parts_.live->facts()) by_name.emplace(fact.name, std::move(fact));
    ordered_json photographs = ordered_json::array();
    for (const Upload& upload : parts_.uploads->uploads_of(user.number)) {
        ordered_json entry{{"sha256", upload.sha256}, {"name", upload.title}};
        const auto fact = by_name.find(upload.file);
        entry["state"] = fact == by_name.end() ? "queued" : state_name(fact->second.state);
        entry["words"] = fact == by_name.end() ? "is about to be looked at" : fact->second.words;
        entry["advice"] = fact == by_name.end() ? "" : fact->second.advice;
        photographs.push_back(std::move(entry));
    }
    return json_response(
        200, json_text(nlohmann::ordered_json{{"photographs", std::move(photographs)}}));
}

}  // namespace psfm
