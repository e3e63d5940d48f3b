// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/session/session_store.h"

#include "storage/database/database_options.h"
#include "storage/database/record_reads.h"
#include "storage/database/session_folder.h"
#include "storage/database/system_error.h"
#include "storage/session/session_writer.h"
#include "storage/session/store_seams.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;

Error not_there(const fs::path& folder) {
    return {ErrorCode::kNotFound,
            "there is no psfm session in " + quoted(folder) + "; 'psfm run' makes one"};
}

Error no_folder(const fs::path& folder, const std::error_code& error) {
    return system_error("cannot make the folder " + quoted(folder), error.value());
}

/// Takes the lock, and only then believes what the folder says.
Result<std::unique_ptr<Database>> open_locked(const fs::path& folder, const StoreOptions& options,
                                              const StoreSeams& seams) {
    auto lock = SessionLock::acquire(folder);
    if (!lock.ok()) return lock.error();
    const auto state = inspect_session_folder(folder);
    if (!state.ok()) return state.error();
    const bool is_new = *state == FolderState::kNew;
    auto database = Database::open_primary(folder, std::move(*lock),
                                           is_new ? DatabaseMode::kCreate : DatabaseMode::kExisting,
                                           options, seams.env);
    if (!database.ok()) return database.error();
    // The marker comes last: with it, a database that is not there is damage, and not made anew.
    if (is_new) {
        if (const auto marked = write_session_marker(folder); !marked.ok()) return marked.error();
    }
    remove_stale_reader_folders(folder);
    return database;
}

}  // namespace

Result<WriterState> WriterState::read(const Database& database) {
    const ReadView view(database);
    const auto images = count_images(view, Family::kImages);
    if (!images.ok()) return images.error();
    const auto verified = count_images(view, Family::kPairs);
    if (!verified.ok()) return verified.error();
    auto cameras = read_camera_ids(view);
    if (!cameras.ok()) return cameras.error();
    auto clusters = read_clusters(view);
    if (!clusters.ok()) return clusters.error();
    auto superseded = read_superseded(view);
    if (!superseded.ok()) return superseded.error();
    auto scene = read_latest_scene(view);
    if (!scene.ok()) return scene.error();
    return WriterState{*images,
                       *verified,
                       std::move(*cameras),
                       std::move(*clusters),
                       std::move(*superseded),
                       std::move(*scene)};
}

Result<std::unique_ptr<SessionStore>> open_session_store(const fs::path& folder,
                                                         const StoreOptions& options, OpenMode mode,
                                                         const StoreSeams& seams) {
    const auto state = inspect_session_folder(folder);
    if (!state.ok() && state.error().code == ErrorCode::kInvalidArgument &&
        mode == OpenMode::kExistingOnly)
        return not_there(folder);
    if (!state.ok()) return state.error();
    if (*state == FolderState::kNew) {
        if (mode == OpenMode::kExistingOnly) return not_there(folder);
        std::error_code error;
        fs::create_directories(folder, error);
        if (error) return no_folder(folder, error);
    }
    auto database = open_locked(folder, options, seams);
    if (!database.ok()) return database.error();
    auto writer_state = WriterState::read(**database);
    if (!writer_state.ok()) return writer_state.error();
    auto writer =
        std::make_unique<SessionWriter>(std::move(*database), std::move(*writer_state), options);
    if (const auto kept = writer->keep_history(options.history); !kept.ok()) return kept.error();
    return std::unique_ptr<SessionStore>(std::move(writer));
}

Result<std::unique_ptr<SessionStore>> SessionStore::open(const fs::path& folder,
                                                         const StoreOptions& options) {
    return open_session_store(folder, options, OpenMode::kOpenOrCreate, {});
}

Result<std::unique_ptr<SessionStore>> SessionStore::open_existing(const fs::path& folder,
                                                                  const StoreOptions& options) {
    return open_session_store(folder, options, OpenMode::kExistingOnly, {});
}

Result<std::unique_ptr<SessionReader>> open_session_reader(const fs::path& folder,
                                                           const StoreOptions& options) {
    const auto state = inspect_session_folder(folder);
    if (!state.ok() && state.error().code == ErrorCode::kInvalidArgument) return not_there(folder);
    if (!state.ok()) return state.error();
    if (*state == FolderState::kNew) return not_there(folder);
    auto scratch = ReaderFolder::make(folder);
    if (!scratch.ok()) return scratch.error();
    auto database = Database::open_secondary(folder, std::move(*scratch), options);
    if (!database.ok()) return database.error();
    return std::unique_ptr<SessionReader>(std::make_unique<ReaderOf<SessionReader>>(
        std::move(*database), decoded_cache_bytes(options)));
}

}  // namespace psfm
