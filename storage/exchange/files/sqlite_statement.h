// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to storage/exchange: SQLite with owners and Results. What SQLite says of a failure is
// for programmers; the errors made here name the file and what a person can do.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "graph/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace psfm {

class SqliteConnection;

/// A prepared statement. Parameters are bound by position from 1, columns read from 0. What is
/// bound is not copied: it stays alive until step(). A failure to bind is told by step().
class SqliteStatement {
  public:
    SqliteStatement() = default;

    SqliteStatement& bind(int position, std::int64_t value);
    SqliteStatement& bind(int position, std::string_view text);
    SqliteStatement& bind(int position, std::span<const std::byte> blob);

    /// @return whether there is a row. REQUIRES: the connection is open, here and below
    Result<bool> step();
    /// Ends the statement and forgets its parameters, ready for the next use.
    void reset();
    /// step() of a statement without rows, and reset().
    Result<void> run();

    // Of the present row.

    /// Nothing unless the value is stored as an integer.
    std::optional<std::int64_t> integer(int column) const;
    /// Nothing unless it is stored as text. Valid until the next call of step() or reset().
    std::optional<std::string_view> text(int column) const;
    /// Nothing unless it is a blob, or NULL (which is an empty one). Valid as text() is.
    std::optional<std::span<const std::byte>> blob(int column) const;

  private:
    friend class SqliteConnection;
    struct Finalizer {
        void operator()(sqlite3_stmt* statement) const;
    };

    const SqliteConnection* connection_ = nullptr;
    std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
    int bind_failure_ = 0;
};

/// An open database file. Not movable, since statements refer to it; they end before it does. Not
/// thread-safe.
class SqliteConnection {
  public:
    SqliteConnection() = default;
    SqliteConnection(const SqliteConnection&) = delete;
    SqliteConnection& operator=(const SqliteConnection&) = delete;

    /// Opens an existing file for reading and stays with its present contents; leaves nothing
    /// beside it. Views, triggers and functions in the file's schema stay without effect.
    /// @errors kNotFound, kUnreadable (no SQLite file, no permission, locked), kDamaged
    Result<void> open_to_read(const std::filesystem::path& file);
    /// Makes a new file, without a journal: a failure leaves it useless, to be removed.
    /// @param shown  the path that errors name
    /// @errors kNoSpace, kIo, here and in what follows
    Result<void> create(const std::filesystem::path& file, const std::filesystem::path& shown);

    Result<void> execute(const std::string& sql);
    Result<SqliteStatement> prepare(const std::string& sql);
    /// REQUIRES: no statement is left
    Result<void> close();

    const std::filesystem::path& path() const { return path_; }
    /// The error for SQLite's extended result code, in words for people.
    Error error(int code) const;

  private:
    struct Closer {
        void operator()(sqlite3* database) const;
    };

    Result<void> open(const std::string& name, int flags);

    std::filesystem::path path_;  ///< as errors name it
    bool writes_ = false;
    std::unique_ptr<sqlite3, Closer> database_;
};

}  // namespace psfm
