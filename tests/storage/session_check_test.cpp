// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "storage/records/record_envelope.h"
#include "storage/records/record_key.h"
#include "tests/storage/child_process.h"
#include "tests/storage/random_values.h"
#include "tests/storage/raw_database.h"
#include "tests/storage/test_session.h"

namespace psfm {
namespace {

namespace fs = std::filesystem;
using testing::ChildProcess;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using testing::RawDatabase;
using testing::TemporaryFolder;

void make_session(const TemporaryFolder& folder, std::uint32_t images) {
    const auto store = SessionStore::open(folder.session(), {});
    ASSERT_TRUE(store.ok());
    ASSERT_TRUE((*store)->put_settings({"/photos", "{}"}).ok());
    ASSERT_TRUE((*store)->commit_rejected({"bad.jpg", "is empty", 0, 0}).ok());
    for (std::uint32_t image = 0; image < images; ++image) {
        ASSERT_TRUE(testing::commit_all(**store, image));
    }
}

std::vector<DamagedRecord> damage_of(const TemporaryFolder& folder) {
    const auto reader = open_session_reader(folder.session(), {});
    EXPECT_TRUE(reader.ok()) << reader.error().message;
    const auto report = (*reader)->check({});
    EXPECT_TRUE(report.ok());
    return report->damaged;
}

auto damage(const std::string& kind, const std::string& key) {
    return Contains(
        ::testing::AllOf(Field(&DamagedRecord::kind, kind), Field(&DamagedRecord::key, key)));
}

TEST(SessionCheck, CountsEveryRecordOfASoundSession) {
    const TemporaryFolder folder;
    make_session(folder, 7);
    const auto store = SessionStore::open_existing(folder.session(), {});
    std::uint64_t last = 0;
    const auto report = (*store)->check([&](std::uint64_t done) { last = done; });
    ASSERT_TRUE(report.ok());
    EXPECT_TRUE(report->damaged.empty());
    std::uint64_t sum = 0;
    for (const auto& [kind, count] : report->records) sum += count;
    EXPECT_EQ(last, sum);
    // settings, camera, rejected; 7 x (image, keypoints, descriptors, pairs); cluster;
    // 5 solutions, points of the last; 7 versions
    EXPECT_EQ(sum, 3U + 28U + 1U + 5U + 1U + 7U);
}

TEST(SessionCheck, NamesEveryKindOfDamagedRecord) {
    const TemporaryFolder folder;
    make_session(folder, 7);
    const SolutionKey solution{ClusterId{0}, testing::expected_solution(6).revision};
    const std::vector<std::pair<Family, std::string>> records{
        {Family::kMeta, settings_key()},
        {Family::kMeta, camera_key(CameraId{0})},
        {Family::kMeta, rejected_key("bad.jpg")},
        {Family::kImages, encode_key(ImageId{2})},
        {Family::kKeypoints, encode_key(ImageId{2})},
        {Family::kDescriptors, encode_key(ImageId{2})},
        {Family::kPairs, encode_key(ImageId{2})},
        {Family::kClusters, encode_key(ClusterId{0})},
        {Family::kSolutions, encode_key(solution)},
        {Family::kPoints, encode_key(solution)},
        {Family::kScenes, encode_key(SceneKey{4, 4})},
    };
    {
        RawDatabase raw(folder.session());
        for (const auto& [family, key] : records) {
            std::string value = raw.get(family, key);
            value[value.size() / 2] = static_cast<char>(value[value.size() / 2] ^ 0x10);
            raw.put(family, key, value);
        }
    }
    const auto damaged = damage_of(folder);
    EXPECT_EQ(damaged.size(), records.size());
    for (const auto& [family, key] : records) {
        EXPECT_THAT(damaged, damage(name_of(family), describe_key(family, key)));
    }
}

TEST(SessionCheck, NamesWhatIsMissing) {
    const TemporaryFolder folder;
    make_session(folder, 7);
    const SolutionKey latest{ClusterId{0}, testing::expected_solution(6).revision};
    const SolutionKey earlier{ClusterId{0}, 2};
    struct Case {
        Family family;
        std::string key;
        std::string reported_as;
        std::string reported_key;
    };
    const std::vector<Case> cases{
        {Family::kMeta, camera_key(CameraId{0}), "images", "image 0"},
        {Family::kImages, encode_key(ImageId{2}), "images", "image 2"},
        {Family::kKeypoints, encode_key(ImageId{3}), "keypoints", "image 3"},
        {Family::kDescriptors, encode_key(ImageId{4}), "descriptors", "image 4"},
        {Family::kPairs, encode_key(ImageId{5}), "pairs", "image 5"},
        {Family::kSolutions, encode_key(latest), "solutions",
         describe_key(Family::kSolutions, encode_key(latest))},
        {Family::kSolutions, encode_key(earlier), "scenes", "version 4, 4 images"},
        {Family::kPoints, encode_key(latest), "points",
         describe_key(Family::kPoints, encode_key(latest))},
    };
    {
        RawDatabase raw(folder.session());
        for (const Case& c : cases) raw.remove(c.family, c.key);
    }
    const auto damaged = damage_of(folder);
    for (const Case& c : cases) EXPECT_THAT(damaged, damage(c.reported_as, c.reported_key));
}

TEST(SessionCheck, KnowsRecordsOfNewerVersionsAndStrangeKeys) {
    const TemporaryFolder folder;
    make_session(folder, 2);
    {
        RawDatabase raw(folder.session());
        raw.put(Family::kMeta, settings_key(),
                seal_record(RecordKind::kSettings, settings_key(), "later", 2));
        raw.put(Family::kImages, "odd", "value");
    }
    const auto damaged = damage_of(folder);
    EXPECT_THAT(damaged, damage("images", "key 6f6464"));
    EXPECT_THAT(damaged, Contains(Field(&DamagedRecord::problem, HasSubstr("newer version"))));
    const auto reader = open_session_reader(folder.session(), {});
    EXPECT_EQ((*reader)->settings().error().code, ErrorCode::kVersion);
}

std::vector<fs::path> files_ending(const fs::path& folder, const std::string& extension) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder)) {
        if (entry.path().extension() == extension && entry.file_size() > 0) {
            files.push_back(entry.path());
        }
    }
    std::ranges::sort(files);
    return files;
}

void flip(const fs::path& path, std::uint64_t offset, int mask) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(offset));
    const int byte = file.get();
    file.seekp(static_cast<std::streamoff>(offset));
    file.put(static_cast<char>(byte ^ mask));
}

struct FlipOutcome {
    bool detected = false;
    std::string difference;  ///< of what could be read nevertheless
};

/// Who opens a session with a flipped byte, and reads everything.
enum class OpenBy { kReader, kReaderAndWriter };

FlipOutcome read_flipped(const fs::path& session, std::uint32_t images, OpenBy open_by) {
    FlipOutcome outcome;
    const auto look = [&](const SessionReader& reader) {
        const auto report = reader.check({});
        if (!report || !report->damaged.empty()) outcome.detected = true;
        const std::string text = testing::difference(reader);
        // Errors are detections; "... differ" would be a value that was changed in silence.
        if (text.find("differ") != std::string::npos) outcome.difference = text;
        if (!text.empty()) outcome.detected = true;
        if (const auto all = reader.images(); all && all->size() < images) {
            outcome.difference += "images lost in silence";
        }
    };
    {
        const auto reader = open_session_reader(session, {});
        if (reader)
            look(**reader);
        else
            outcome.detected = true;
    }
    if (open_by == OpenBy::kReader) return outcome;
    const auto store = SessionStore::open_existing(session, {});
    if (store)
        look(**store);
    else
        outcome.detected = true;
    return outcome;
}

TEST(SessionCheck, FlippedBytesInTablesNeverChangeWhatIsRead) {
    const TemporaryFolder folder;
    constexpr std::uint32_t kImages = 6;
    make_session(folder, kImages);
    const fs::path copy = folder.path() / "copy";
    testing::Rng rng(4);
    int detected = 0;
    constexpr int kFlips = 40;
    for (int i = 0; i < kFlips; ++i) {
        fs::remove_all(copy);
        fs::copy(folder.session(), copy, fs::copy_options::recursive);
        const auto tables = files_ending(copy / "db", ".sst");
        ASSERT_FALSE(tables.empty());
        const fs::path& table = tables[rng() % tables.size()];
        flip(table, rng() % fs::file_size(table), 1 << (rng() % 8));
        // RocksDB's background work waits a second when it meets damage, so fewer writers.
        const OpenBy open_by = i % 20 == 0 ? OpenBy::kReaderAndWriter : OpenBy::kReader;
        const FlipOutcome outcome = read_flipped(copy, kImages, open_by);
        EXPECT_EQ(outcome.difference, "");
        detected += outcome.detected ? 1 : 0;
    }
    // A few bytes of a table (padding of its footer, statistics) are never read.
    EXPECT_GE(detected, kFlips * 7 / 10);
}

TEST(SessionCheck, FlippedBytesInTheLogAreNeverCutOffInSilence) {
    const TemporaryFolder folder;
    constexpr std::uint32_t kImages = 6;
    ChildProcess writer({"leave", folder.session().string(), std::to_string(kImages)});
    while (!writer.read_line().empty()) {
    }
    ASSERT_EQ(writer.finish(), 0);
    const fs::path copy = folder.path() / "copy";
    testing::Rng rng(5);
    int detected = 0;
    constexpr int kFlips = 30;
    for (int i = 0; i < kFlips; ++i) {
        fs::remove_all(copy);
        fs::copy(folder.session(), copy, fs::copy_options::recursive);
        const auto logs = files_ending(copy / "db", ".log");
        ASSERT_FALSE(logs.empty());
        const fs::path& log = logs[rng() % logs.size()];
        // Not within the last commit: damage there looks like a torn write.
        flip(log, rng() % (fs::file_size(log) * 3 / 4), 1 << (rng() % 8));
        const OpenBy open_by = i % 2 == 0 ? OpenBy::kReader : OpenBy::kReaderAndWriter;
        const FlipOutcome outcome = read_flipped(copy, kImages, open_by);
        EXPECT_EQ(outcome.difference, "");
        detected += outcome.detected ? 1 : 0;
    }
    EXPECT_EQ(detected, kFlips);
}

TEST(SessionCheck, StepsOverADamagedBlockAndGoesOn) {
    const TemporaryFolder folder;
    constexpr std::uint32_t kImages = 12;
    make_session(folder, kImages);
    // The bytes of one keypoint record, found in the tables, changed in place.
    const Keypoints keypoints = testing::expected_keypoints(5);
    const std::string needle(reinterpret_cast<const char*>(keypoints.data()), 64);
    bool found = false;
    for (const fs::path& table : files_ending(folder.session() / "db", ".sst")) {
        std::ifstream file(table, std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), {});
        const std::size_t at = bytes.find(needle);
        if (at == std::string::npos) continue;
        file.close();
        flip(table, at, 0x04);
        found = true;
    }
    ASSERT_TRUE(found);
    const auto damaged = damage_of(folder);
    ASSERT_FALSE(damaged.empty());
    for (const DamagedRecord& record : damaged) EXPECT_EQ(record.kind, "keypoints");
    EXPECT_THAT(damaged, Contains(Field(&DamagedRecord::problem, HasSubstr("checksum"))));
    const auto reader = open_session_reader(folder.session(), {});
    EXPECT_EQ((*reader)->keypoints(ImageId{5}).error().code, ErrorCode::kDamaged);
    EXPECT_TRUE((*reader)->descriptors(ImageId{5}).ok());
    EXPECT_EQ((*reader)->images()->size(), kImages);
    const auto report = (*reader)->check({});
    EXPECT_THAT(report->records,
                Contains(std::pair<std::string, std::uint64_t>("descriptors", kImages)));
}

}  // namespace
}  // namespace psfm
