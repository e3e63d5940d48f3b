// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace psfm {

/// Why something could not be done. The values are for programs, the message beside it for people.
enum class ErrorCode {
    kInvalidArgument,  ///< an option or input is outside its range
    kNotFound,         ///< file, record or image that does not exist
    kUnreadable,       ///< exists, but cannot be opened or decoded
    kDuplicate,        ///< the same content is already there
    kTooFewMatches,    ///< not enough correspondences for the model asked for
    kDegenerate,       ///< the data do not determine a solution
    kNoSeed,           ///< no image pair to start a reconstruction from
    kInUse,            ///< another process holds the session
    kDamaged,          ///< stored bytes fail their checksum or grammar
    kVersion,          ///< written by a newer version
    kNoSpace,          ///< disk full
    kIo,               ///< any other failure of the operating system
    kCancelled,        ///< stopped on request
    kInternal,         ///< an exception from a library
};

struct Error {
    ErrorCode code = ErrorCode::kInternal;
    std::string message;  ///< one line that names the thing and the remedy
};

/// Value or error. g++ 12 has no std::expected.
template <typename T>
class [[nodiscard]] Result {
  public:
    // Implicit by design: `return value;` and `return Error{…};` both read as they are meant.
    // NOLINTNEXTLINE(google-explicit-constructor)
    Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
    // NOLINTNEXTLINE(google-explicit-constructor)
    Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

    bool ok() const { return content_.index() == 0; }
    explicit operator bool() const { return ok(); }

    /// REQUIRES: ok()
    const T& value() const& {
        assert(ok());
        return std::get<0>(content_);
    }
    T& value() & {
        assert(ok());
        return std::get<0>(content_);
    }
    T&& value() && {
        assert(ok());
        return std::get<0>(std::move(content_));
    }
    const T& operator*() const& { return value(); }
    T& operator*() & { return value(); }
    T&& operator*() && { return std::move(*this).value(); }
    const T* operator->() const { return &value(); }
    T* operator->() { return &value(); }

    /// REQUIRES: !ok()
    const Error& error() const {
        assert(!ok());
        return std::get<1>(content_);
    }

  private:
    std::variant<T, Error> content_;
};

/// Success without a value, or an error.
template <>
class [[nodiscard]] Result<void> {
  public:
    Result() = default;
    // NOLINTNEXTLINE(google-explicit-constructor)
    Result(Error error) : failed_(true), error_(std::move(error)) {}

    bool ok() const { return !failed_; }
    explicit operator bool() const { return ok(); }
    /// REQUIRES: !ok()
    const Error& error() const {
        assert(!ok());
        return error_;
    }

  private:
    bool failed_ = false;
    Error error_;
};

}  // namespace psfm
