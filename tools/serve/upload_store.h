// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "graph/result.h"
#include "scheduler/flow/run_session.h"
#include "tools/report/image_facts.h"
#include "tools/serve/http.h"
#include "tools/serve/uploads/sent_book.h"
#include "tools/serve/uploads/unfinished_uploads.h"

namespace psfm {

struct UploadLimits {
    std::uint64_t most_bytes = std::uint64_t{64} << 20U;   ///< of a photograph
    std::uint64_t quota_bytes = std::uint64_t{20} << 30U;  ///< of all that a user sends
    std::uint64_t free_bytes = std::uint64_t{1} << 30U;    ///< of the disk that stay free
    std::size_t at_once = 16;                              ///< uploads; more are told to wait
    std::size_t at_once_of_user = 4;                       ///< so that one leaves room for others
    std::int64_t abandoned_seconds = 3600;  ///< from one look for what is abandoned to the next
    /// Photographs that wait for the engine; more are told to wait. Higher: a longer way from
    /// sending to seeing; lower: the engine may run dry.
    std::size_t queue = 64;
};

/// Photographs that users send: content-addressed, resumable, and acknowledged once they are
/// durable. SESSION/photographs/USER/SHA256.EXTENSION, beside it what has begun to come; and
/// SESSION/uploads.log, a line of JSON for each that was acknowledged, in order, and for each user
/// who sent it again. Both are the truth after a crash: what has a line is there. Thread-safe.
class UploadStore {
  public:
    /// @errors kIo, kDamaged
    static Result<std::unique_ptr<UploadStore>> open(const std::filesystem::path& session,
                                                     const UploadLimits& limits);

    const std::filesystem::path& folder() const { return folder_; }

    /// What is here of a photograph that a user sends or has sent.
    struct Progress {
        std::uint64_t offset = 0;  ///< bytes
        std::uint64_t length = 0;  ///< that it will have; 0: it has not begun
        bool complete = false;
    };
    Progress progress(std::uint32_t user, const std::string& sha256) const;

    struct Offer {
        std::uint32_t user = 0;
        std::string sha256;
        std::string title;
        std::uint64_t offset = 0;             ///< where the bytes begin
        std::optional<std::uint64_t> length;  ///< of the whole photograph; nothing: as announced
        bool anew = false;                    ///< instead of what has come so far
    };
    /// What becomes of bytes that somebody wants to send.
    struct Admission {
        std::optional<HttpResponse> refusal;  ///< an answer instead
        std::unique_ptr<BodySink> sink;
        std::uint64_t most_body = 0;  ///< bytes that are still wanted
    };
    /// Does not wait for the disk but for a look at a file's length.
    Admission admit(const Offer& offer);

    /// A photograph that somebody has sent is his no more, and nothing is left of what he has begun
    /// to send of it; when it is nobody's, its file and thumbnail are removed, and the session is
    /// to lose it (take_removed). On a thread that may wait for the disk.
    /// @param whoever_sent  it is nobody's afterwards
    /// @return 204, or why not
    HttpResponse remove(std::uint32_t user, const std::string& sha256, bool whoever_sent);
    bool has_removed() const;
    /// Names in the session of photographs that were removed and that it may still have, those of
    /// earlier processes among them.
    std::vector<std::string> take_removed();

    /// All that a user has sent, also after somebody else, in order.
    std::vector<Upload> uploads_of(std::uint32_t user) const;
    std::optional<Upload> find(const std::string& sha256) const;
    /// By the photograph's name in the session: an OriginOf's answer.
    std::optional<PhotographOrigin> origin_of(const std::string& file) const;

    /// The next photograph for the engine; nothing at present.
    std::optional<PhotoFile> take();
    std::size_t waiting() const;
    /// Photographs that were sent and the session lacks: they wait (again).
    void queue_missing(const std::set<std::string>& known_names);

  private:
    friend class UploadSink;
    UploadStore(std::filesystem::path session, const UploadLimits& limits);
    // Under the lock:
    Progress begun(std::uint32_t user, const std::string& sha256) const;
    std::optional<HttpResponse> refuse_place(const Offer& offer, const Progress& here) const;
    std::optional<HttpResponse> refuse_share(const Offer& offer, std::uint64_t length) const;
    HttpResponse know_again(const Offer& offer);
    /// What has come of a user's photograph is gone. @return whether he had begun to send it
    bool drop_unfinished(std::uint32_t user, const std::string& sha256);
    void remove_abandoned();
    // Of a sink, on the disk thread; `part` is where its bytes are.
    void give_up(const Offer& offer, const std::filesystem::path& part);
    HttpResponse complete(const Offer& offer, const std::filesystem::path& part);
    void release(const Offer& offer, const std::filesystem::path& part);

    std::filesystem::path session_, folder_;
    UploadLimits limits_;
    mutable std::mutex mutex_;
    SentBook book_;
    UnfinishedUploads unfinished_;  // count for the quota, too
    std::int64_t look_for_abandoned_ = 0;
    std::map<std::string, std::uint32_t> open_;  // hashes that are sent at present, and by whom
    std::deque<PhotoFile> queue_;
    std::set<std::string> removed_;  // by name in the session, since take_removed()
};

/// What users send, for run_session; never ends.
class UploadSource final : public PhotoSource {
  public:
    explicit UploadSource(UploadStore& store) : store_(&store) {}
    Next next(PhotoFile& photo) override;

  private:
    UploadStore* store_;
};

}  // namespace psfm
