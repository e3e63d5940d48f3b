// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/files/sqlite_statement.h"

#include <sqlite3.h>

#include <cerrno>

#include "storage/exchange/files/output_file.h"
#include "storage/exchange/files/sqlite_file.h"

namespace psfm {
namespace {

/// Guard: how long a program that writes the file just now is waited for. Ours: a commit takes
/// less.
constexpr int kBusyMilliseconds = 1000;

/// Hostile files: no functions or virtual tables called from the schema, no views, no triggers,
/// page contents checked as they are read, no mapped memory (which a truncated file turns into a
/// crash).
constexpr const char* kReadingSettings =
    "PRAGMA trusted_schema=OFF; PRAGMA cell_size_check=ON; PRAGMA mmap_size=0; "
    "PRAGMA query_only=ON; BEGIN";
/// The file is new and nobody else's: it is removed when it is not finished.
constexpr const char* kWritingSettings =
    "PRAGMA journal_mode=OFF; PRAGMA synchronous=OFF; PRAGMA locking_mode=EXCLUSIVE";

}  // namespace

void SqliteStatement::Finalizer::operator()(sqlite3_stmt* statement) const {
    sqlite3_finalize(statement);
}

void SqliteConnection::Closer::operator()(sqlite3* database) const {
    sqlite3_close_v2(database);
}

SqliteStatement& SqliteStatement::bind(int position, std::int64_t value) {
    const int code = sqlite3_bind_int64(statement_.get(), position, value);
    if (bind_failure_ == SQLITE_OK) bind_failure_ = code;
    return *this;
}

SqliteStatement& SqliteStatement::bind(int position, std::string_view text) {
    const int code = sqlite3_bind_text64(statement_.get(), position, text.data(), text.size(),
                                         SQLITE_STATIC, SQLITE_UTF8);
    if (bind_failure_ == SQLITE_OK) bind_failure_ = code;
    return *this;
}

SqliteStatement& SqliteStatement::bind(int position, std::span<const std::byte> blob) {
    const int code =
        sqlite3_bind_blob64(statement_.get(), position, blob.data(), blob.size(), SQLITE_STATIC);
    if (bind_failure_ == SQLITE_OK) bind_failure_ = code;
    return *this;
}

Result<bool> SqliteStatement::step() {
    if (bind_failure_ != SQLITE_OK) return connection_->error(bind_failure_);
    const int code = sqlite3_step(statement_.get());
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) return false;
    return connection_->error(code);
}

void SqliteStatement::reset() {
    sqlite3_reset(statement_.get());
    sqlite3_clear_bindings(statement_.get());
    bind_failure_ = SQLITE_OK;
}

Result<void> SqliteStatement::run() {
    const auto stepped = step();
    reset();
    if (!stepped.ok()) return stepped.error();
    return {};
}

std::optional<std::int64_t> SqliteStatement::integer(int column) const {
    if (sqlite3_column_type(statement_.get(), column) != SQLITE_INTEGER) return std::nullopt;
    return sqlite3_column_int64(statement_.get(), column);
}

std::optional<std::string_view> SqliteStatement::text(int column) const {
    if (sqlite3_column_type(statement_.get(), column) != SQLITE_TEXT) return std::nullopt;
    const auto* characters = sqlite3_column_text(statement_.get(), column);
    if (characters == nullptr) return std::nullopt;  // out of memory
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
    return std::string_view(reinterpret_cast<const char*>(characters), size);
}

std::optional<std::span<const std::byte>> SqliteStatement::blob(int column) const {
    const int type = sqlite3_column_type(statement_.get(), column);
    if (type != SQLITE_BLOB && type != SQLITE_NULL) return std::nullopt;
    const auto* bytes =
        static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
    if (bytes == nullptr) return std::span<const std::byte>{};
    return std::span(bytes,
                     static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column)));
}

Result<void> SqliteConnection::open(const std::string& name, int flags) {
    sqlite3* opened = nullptr;
    const int code = sqlite3_open_v2(name.c_str(), &opened, flags, nullptr);
    database_.reset(opened);  // to be closed also after a failure
    if (code != SQLITE_OK) return error(opened ? sqlite3_extended_errcode(opened) : code);
    sqlite3_extended_result_codes(opened, 1);
    sqlite3_busy_timeout(opened, kBusyMilliseconds);
    return {};
}

Result<void> SqliteConnection::open_to_read(const std::filesystem::path& file) {
    path_ = file;
    const auto look = look_at_sqlite_file(file);
    if (!look.ok()) return look.error();
    const auto opened = open(sqlite_uri(file, look->lies_still),
                             SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX);
    if (!opened.ok()) return opened.error();
    for (const int off : {SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW}) {
        sqlite3_db_config(database_.get(), off, 0, nullptr);
    }
    return execute(kReadingSettings);
}

Result<void> SqliteConnection::create(const std::filesystem::path& file,
                                      const std::filesystem::path& shown) {
    path_ = shown;
    writes_ = true;
    const auto opened = open(sqlite_uri(file, false), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE |
                                                          SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX);
    if (!opened.ok()) return opened.error();
    return execute(kWritingSettings);
}

Result<void> SqliteConnection::execute(const std::string& sql) {
    const int code = sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr);
    if (code != SQLITE_OK) return error(code);
    return {};
}

Result<SqliteStatement> SqliteConnection::prepare(const std::string& sql) {
    sqlite3_stmt* prepared = nullptr;
    const int code = sqlite3_prepare_v3(database_.get(), sql.c_str(), -1, SQLITE_PREPARE_PERSISTENT,
                                        &prepared, nullptr);
    if (code != SQLITE_OK) return error(code);
    SqliteStatement statement;
    statement.connection_ = this;
    statement.statement_.reset(prepared);
    return statement;
}

Result<void> SqliteConnection::close() {
    sqlite3* database = database_.release();
    const int code = sqlite3_close(database);
    if (code == SQLITE_OK) return {};
    database_.reset(database);
    return error(code);
}

Error SqliteConnection::error(int code) const {
    const std::string name = path_.string();
    const int system = database_ ? sqlite3_system_errno(database_.get()) : 0;
    switch (code & 0xff) {
        case SQLITE_NOTADB:
            return not_a_database(path_);
        case SQLITE_CORRUPT:
        case SQLITE_TOOBIG:
        case SQLITE_ERROR:  // a schema that does not parse
            return damaged_database(path_, "its pages or tables contradict each other");
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return {ErrorCode::kUnreadable,
                    name +
                        " is locked by another program that writes to it: wait until that is "
                        "done, or close it"};
        case SQLITE_FULL:
            return file_error(path_, ENOSPC);
        case SQLITE_NOMEM:
            return {ErrorCode::kIo, name + ": not enough memory; close other programs"};
        case SQLITE_CONSTRAINT:
            return {ErrorCode::kDuplicate,
                    name + ": the same camera, image, name or pair is written twice"};
        default:
            break;
    }
    if (writes_) return file_error(path_, system != 0 ? system : EIO);
    return {ErrorCode::kUnreadable,
            name +
                " cannot be read: check its permissions and those of its folder, or copy it, "
                "with the files beside it that have its name and -wal or -journal, to another "
                "folder"};
}

}  // namespace psfm
