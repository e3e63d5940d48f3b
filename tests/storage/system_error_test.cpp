// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/system_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rocksdb/status.h>

#include <cerrno>
#include <system_error>

namespace psfm {
namespace {

using rocksdb::Status;
using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kAboutPermissions = "chmod";

std::string words(int error_number) {
    return std::generic_category().message(error_number);
}

TEST(SystemError, WhereAPermissionIsLackingThatIsTheRemedy) {
    for (const int denial : {EACCES, EPERM}) {
        EXPECT_THAT(
            system_error("cannot open '/s/writer.lock'", denial).message,
            AllOf(HasSubstr("'/s/writer.lock': " + words(denial)), HasSubstr(kAboutPermissions)));
    }
    EXPECT_THAT(system_error("cannot open '/s/writer.lock'", EIO).message, EndsWith(words(EIO)));
}

TEST(DatabaseError, WhereAPermissionIsLackingThatIsTheRemedy) {
    const Status denials[] = {
        Status::IOError("While open a file for random read: /s/db/7.sst", words(EACCES)),
        // What RocksDB calls its options file is none of the session's damage.
        Status::InvalidArgument("Found options incompatible: IO error: /s/db/CURRENT",
                                words(EACCES)),
        Status::IOError("While open a file for appending: /s/db/7.log", words(EPERM))};
    for (const Status& denial : denials) {
        const Error error = database_error("session '/s'", denial);
        EXPECT_EQ(error.code, ErrorCode::kIo);
        EXPECT_THAT(error.message, AllOf(HasSubstr("/s/db/"), HasSubstr(kAboutPermissions),
                                         Not(HasSubstr("disk")), Not(HasSubstr("resume"))));
    }
    EXPECT_THAT(database_error("session '/s'", Status::IOError("/s/db/7.sst", words(EIO))).message,
                HasSubstr("look after the disk"));
}

}  // namespace
}  // namespace psfm
