// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/uploads/sent_book.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "storage/exchange/files/json_text.h"
#include "tools/serve/uploads/sha256.h"

namespace psfm {
namespace {

using nlohmann::ordered_json;

/// Between line ends, so that one that was broken off spoils itself alone.
std::string framed(const ordered_json& line) {
    return "\n" + json_text(line) + "\n";
}

}  // namespace

SentBook SentBook::read(const std::filesystem::path& log,
                        const std::function<std::uint64_t(const std::string& file)>& bytes_of) {
    SentBook book;
    std::ifstream stream(log);
    for (std::string line; std::getline(stream, line);) book.take(line, bytes_of);
    return book;
}

std::string SentBook::line_of(const Upload& upload) {
    return framed({{"sha256", upload.sha256},
                   {"user", upload.user},
                   {"name", upload.title},
                   {"file", upload.file},
                   {"time", upload.time}});
}

std::string SentBook::line_of_removal(std::uint32_t user, const std::string& sha256,
                                      bool whoever_sent, std::int64_t time) {
    ordered_json line{{"removed", sha256}, {"user", user}, {"time", time}};
    if (whoever_sent) line["of_all"] = true;
    return framed(line);
}

void SentBook::take(const std::string& line,
                    const std::function<std::uint64_t(const std::string& file)>& bytes_of) {
    const auto said = parse_json(line);
    if (!said.is_object()) return;
    try {
        const auto user = said.at("user").get<std::uint32_t>();
        if (said.contains("removed")) {
            take_back(user, said["removed"].get<std::string>(), said.contains("of_all"));
            return;
        }
        Upload upload{said.at("sha256").get<std::string>(), user,
                      said.at("name").get<std::string>(),   said.at("file").get<std::string>(),
                      said.at("time").get<std::int64_t>(),  0};
        if (!is_sha256(upload.sha256)) return;
        if (bytes_of) upload.bytes = bytes_of(upload.file);
        add(std::move(upload));
    } catch (const nlohmann::json::exception&) {
        return;  // of no program of ours
    }
}

void SentBook::add(Upload upload) {
    if (!sent_by_.emplace(upload.user, upload.sha256).second) return;
    if (by_sha256_.contains(upload.sha256)) {
        repeats_.push_back(std::move(upload));
        return;
    }
    removed_.erase(upload.file);
    bytes_of_user_[upload.user] += upload.bytes;
    by_sha256_[upload.sha256] = by_file_[upload.file] = uploads_.size();
    uploads_.push_back(std::move(upload));
}

std::optional<std::string> SentBook::take_back(std::uint32_t user, const std::string& sha256,
                                               bool whoever_sent) {
    const auto known = by_sha256_.find(sha256);
    if (known == by_sha256_.end()) return std::nullopt;
    std::erase_if(sent_by_, [&](const auto& sent) {
        return sent.second == sha256 && (whoever_sent || sent.first == user);
    });
    std::erase_if(repeats_, [&](const Upload& repeat) {
        return repeat.sha256 == sha256 && (whoever_sent || repeat.user == user);
    });
    Upload& upload = uploads_[known->second];
    if (!whoever_sent && upload.user != user) return std::nullopt;
    bytes_of_user_[upload.user] -= upload.bytes;
    // It stays where it is as long as somebody else has sent it, too.
    if (const auto other = std::ranges::find(repeats_, sha256, &Upload::sha256);
        other != repeats_.end()) {
        upload.user = other->user;
        upload.title = other->title;
        bytes_of_user_[upload.user] += upload.bytes;
        repeats_.erase(other);
        return std::nullopt;
    }
    std::string file = upload.file;
    uploads_.erase(uploads_.begin() + static_cast<std::ptrdiff_t>(known->second));
    by_sha256_.clear();
    by_file_.clear();
    for (std::size_t i = 0; i < uploads_.size(); ++i)
        by_sha256_[uploads_[i].sha256] = by_file_[uploads_[i].file] = i;
    removed_.insert(file);
    return file;
}

std::vector<Upload> SentBook::uploads_of(std::uint32_t user) const {
    std::vector<Upload> sent;
    for (const auto* uploads : {&uploads_, &repeats_}) {
        for (const Upload& upload : *uploads) {
            if (upload.user == user) sent.push_back(upload);
        }
    }
    std::ranges::stable_sort(sent, {}, &Upload::time);
    return sent;
}

bool SentBook::has_sent(std::uint32_t user, const std::string& sha256) const {
    return sent_by_.contains({user, sha256});
}

const Upload* SentBook::find(const std::string& sha256) const {
    const auto known = by_sha256_.find(sha256);
    return known == by_sha256_.end() ? nullptr : &uploads_[known->second];
}

const Upload* SentBook::find_file(const std::string& file) const {
    const auto known = by_file_.find(file);
    return known == by_file_.end() ? nullptr : &uploads_[known->second];
}

std::uint64_t SentBook::bytes_of(std::uint32_t user) const {
    const auto known = bytes_of_user_.find(user);
    return known == bytes_of_user_.end() ? 0 : known->second;
}

}  // namespace psfm
