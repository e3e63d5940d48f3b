// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/database/colmap_database.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "storage/exchange/database/database_blocks.h"
#include "storage/exchange/database/database_tables.h"
#include "storage/exchange/files/sqlite_file.h"
#include "storage/exchange/files/sqlite_statement.h"

namespace psfm {

struct ColmapDatabase::Connection {
    /// What is known of an image from the keys and counts alone.
    struct Entry {
        std::uint32_t features = 0;
        std::vector<std::uint32_t> partners;  ///< ascending
    };

    Error damaged(const std::string& problem) const {
        return damaged_database(database.path(), problem);
    }
    /// @errors kNotFound
    Result<const Entry*> entry(std::uint32_t image) const {
        const auto found = entries.find(image);
        if (found != entries.end()) return &found->second;
        return Error{ErrorCode::kNotFound, database.path().string() + " has no image " +
                                               std::to_string(image) +
                                               ": ask for one that images() lists"};
    }

    Result<void> open(const std::filesystem::path& file);
    Result<void> read_entries();
    Result<std::vector<FeatureMatch>> read_matches(std::uint32_t first, std::uint32_t second);

    std::mutex mutex;  ///< guards all below, once open
    SqliteConnection database;
    std::optional<colmap::BlockReader> keypoints, descriptors, matches;
    std::map<std::uint32_t, Entry> entries;  ///< of every image
    std::size_t pairs = 0;                   ///< verified, of images that are there
};

namespace {

using colmap::little_endian_at;
using colmap::PairConfig;

/// Each feature at most once a side: of several matches, the first counts. Seen the same from both
/// images.
void make_one_to_one(std::vector<FeatureMatch>& matches) {
    std::ranges::sort(matches);
    std::vector<FeatureMatch> kept;
    kept.reserve(matches.size());
    std::uint32_t bound = 0;
    for (const FeatureMatch& match : matches) bound = std::max(bound, match.second + 1);
    std::vector<bool> second_used(bound, false);
    for (const FeatureMatch& match : matches) {
        if (second_used[match.second]) continue;
        if (!kept.empty() && kept.back().first == match.first) continue;
        second_used[match.second] = true;
        kept.push_back(match);
    }
    matches = std::move(kept);
}

/// Scale and angle of COLMAP's affine shape (a11, a12, a21, a22): FeatureKeypoint::ComputeScale and
/// ComputeOrientation of COLMAP 3.8, src/feature/types.cc.
void set_from_shape(Keypoint& keypoint, const std::array<float, 4>& shape) {
    const auto [a11, a12, a21, a22] = shape;
    keypoint.scale = 0.5F * (std::hypot(a11, a21) + std::hypot(a12, a22));
    keypoint.angle = std::atan2(a21, a11);
}

Keypoint keypoint_of(const colmap::Block& block, std::size_t row) {
    const auto value = [&](std::size_t col) {
        return little_endian_at<float>(block.bytes, row * block.cols + col);
    };
    Keypoint keypoint;
    keypoint.x = value(0);
    keypoint.y = value(1);
    keypoint.scale = 1.0F;
    if (block.cols == 4) {
        keypoint.scale = value(2);
        keypoint.angle = value(3);
    } else if (block.cols == 6) {
        set_from_shape(keypoint, {value(2), value(3), value(4), value(5)});
    }
    // Programs without scales write zeros.
    if (keypoint.scale == 0.0F) keypoint.scale = 1.0F;
    return keypoint;
}

bool is_sound(const Keypoint& keypoint) {
    // Format: from here on float tells no pixel from the next.
    constexpr float kFarthestPixel = 16777216.0F;
    return std::abs(keypoint.x) < kFarthestPixel && std::abs(keypoint.y) < kFarthestPixel &&
           std::isfinite(keypoint.scale) && keypoint.scale > 0.0F && std::isfinite(keypoint.angle);
}

bool counts(PairConfig config) {
    return config != PairConfig::kDegenerate && config != PairConfig::kWatermark;
}

}  // namespace

Result<void> ColmapDatabase::Connection::open(const std::filesystem::path& file) {
    if (auto opened = database.open_to_read(file); !opened.ok()) return opened.error();
    if (auto checked = colmap::check_tables(database); !checked.ok()) return checked.error();
    using colmap::BlockReader;
    auto made = BlockReader::make(database, "keypoints", "image_id", sizeof(float), {2, 4, 6});
    if (!made.ok()) return made.error();
    keypoints = *std::move(made);
    made = BlockReader::make(database, "descriptors", "image_id", 1, {Descriptors::kSize});
    if (!made.ok()) return made.error();
    descriptors = *std::move(made);
    descriptors->pass_over_others();
    made =
        BlockReader::make(database, "two_view_geometries", "pair_id", sizeof(std::uint32_t), {2});
    if (!made.ok()) return made.error();
    matches = *std::move(made);
    return {};
}

/// Reads counts and keys, no blobs. Rows of images that are not there are what COLMAP leaves behind
/// when images are deleted.
Result<void> ColmapDatabase::Connection::read_entries() {
    auto read = colmap::for_each_row(
        database, "SELECT image_id,rows,length(data) FROM keypoints",
        [&](const SqliteStatement& row) -> Result<void> {
            const auto rows = row.integer(1).value_or(-1);
            // Format: x and y of a keypoint.
            const auto least_bytes = static_cast<std::int64_t>(2 * sizeof(float));
            if (rows < 0 || rows > row.integer(2).value_or(0) / least_bytes) {
                return damaged("keypoints has a row that announces more features than it holds");
            }
            const auto image = row.integer(0).value_or(0);
            if (image < 1 || image >= colmap::kMaxImages) return {};
            const auto found = entries.find(static_cast<std::uint32_t>(image));
            if (found != entries.end()) found->second.features = static_cast<std::uint32_t>(rows);
            return {};
        });
    if (!read.ok()) return read.error();
    read = colmap::for_each_row(
        database, "SELECT pair_id,config FROM two_view_geometries WHERE rows<>0",
        [&](const SqliteStatement& row) -> Result<void> {
            const auto pair = colmap::images_of_pair(row.integer(0).value_or(-1));
            if (!pair) return damaged("two_view_geometries has a pair_id of no two images");
            const auto config = row.integer(1).value_or(-1);
            if (config < 0 || config > UINT8_MAX) {
                return damaged("two_view_geometries has a config that is none");
            }
            const auto first = entries.find(pair->first);
            const auto second = entries.find(pair->second);
            if (first == entries.end() || second == entries.end()) return {};
            if (!counts(static_cast<PairConfig>(config))) return {};
            ++pairs;
            first->second.partners.push_back(pair->second);
            second->second.partners.push_back(pair->first);
            return {};
        });
    if (!read.ok()) return read.error();
    for (auto& [image, entry] : entries) {
        std::ranges::sort(entry.partners);
        if (std::ranges::adjacent_find(entry.partners) != entry.partners.end()) {
            return damaged("image " + std::to_string(image) + " is in one pair twice");
        }
    }
    return {};
}

Result<std::vector<FeatureMatch>> ColmapDatabase::Connection::read_matches(std::uint32_t first,
                                                                           std::uint32_t second) {
    const auto block = matches->read(colmap::pair_key(first, second));
    if (!block.ok()) return block.error();
    const std::uint32_t features1 = entries.at(first).features;
    const std::uint32_t features2 = entries.at(second).features;
    std::vector<FeatureMatch> found(block->rows);
    for (std::size_t i = 0; i < found.size(); ++i) {
        found[i] = {little_endian_at<std::uint32_t>(block->bytes, 2 * i),
                    little_endian_at<std::uint32_t>(block->bytes, 2 * i + 1)};
        if (found[i].first >= features1 || found[i].second >= features2) {
            return damaged("images " + std::to_string(first) + " and " + std::to_string(second) +
                           " are matched by features that they do not have");
        }
    }
    make_one_to_one(found);
    return found;
}

ColmapDatabase::ColmapDatabase() : connection_(std::make_unique<Connection>()) {}
ColmapDatabase::~ColmapDatabase() = default;

Result<std::unique_ptr<ColmapDatabase>> ColmapDatabase::open(const std::filesystem::path& file) {
    std::unique_ptr<ColmapDatabase> result(new ColmapDatabase);
    Connection& connection = *result->connection_;
    if (auto opened = connection.open(file); !opened.ok()) return opened.error();
    auto cameras = colmap::read_cameras(connection.database);
    if (!cameras.ok()) return cameras.error();
    result->cameras_ = *std::move(cameras);
    auto images = colmap::read_images(connection.database, result->cameras_);
    if (!images.ok()) return images.error();
    result->images_ = *std::move(images);
    for (const DatabaseImage& image : result->images_) {
        if (connection.entries.try_emplace(image.id).second) continue;
        return connection.damaged("image " + std::to_string(image.id) + " is there twice");
    }
    if (auto read = connection.read_entries(); !read.ok()) return read.error();
    return result;
}

std::size_t ColmapDatabase::verified_pairs() const {
    return connection_->pairs;
}

Result<Keypoints> ColmapDatabase::keypoints(std::uint32_t image) const {
    const std::scoped_lock lock(connection_->mutex);
    const auto entry = connection_->entry(image);
    if (!entry.ok()) return entry.error();
    const auto block = connection_->keypoints->read(image);
    if (!block.ok()) return block.error();
    if (block->rows != (*entry)->features) {
        return connection_->damaged("the features of image " + std::to_string(image) +
                                    " have changed since the database was opened");
    }
    Keypoints keypoints(block->rows);
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
        keypoints[i] = keypoint_of(*block, i);
        if (!is_sound(keypoints[i])) {
            return connection_->damaged("feature " + std::to_string(i) + " of image " +
                                        std::to_string(image) +
                                        " has a place, scale or angle that is none");
        }
    }
    return keypoints;
}

Result<Descriptors> ColmapDatabase::descriptors(std::uint32_t image) const {
    const std::scoped_lock lock(connection_->mutex);
    const auto entry = connection_->entry(image);
    if (!entry.ok()) return entry.error();
    const auto block = connection_->descriptors->read(image);
    if (!block.ok()) return block.error();
    if (block->rows != 0 && block->rows != (*entry)->features) {
        return connection_->damaged("image " + std::to_string(image) + " has " +
                                    std::to_string((*entry)->features) + " features, but " +
                                    std::to_string(block->rows) + " descriptors");
    }
    Descriptors descriptors;
    descriptors.values.resize(block->bytes.size());
    std::ranges::transform(block->bytes, descriptors.values.begin(),
                           [](std::byte value) { return std::to_integer<std::uint8_t>(value); });
    return descriptors;
}

Result<std::vector<DatabaseMatches>> ColmapDatabase::matches(std::uint32_t image) const {
    const std::scoped_lock lock(connection_->mutex);
    const auto entry = connection_->entry(image);
    if (!entry.ok()) return entry.error();
    std::vector<DatabaseMatches> all;
    all.reserve((*entry)->partners.size());
    for (const std::uint32_t other : (*entry)->partners) {
        auto found = connection_->read_matches(std::min(image, other), std::max(image, other));
        if (!found.ok()) return found.error();
        DatabaseMatches& pair = all.emplace_back(DatabaseMatches{other, *std::move(found)});
        if (image < other) continue;
        for (FeatureMatch& match : pair.matches) std::swap(match.first, match.second);
        std::ranges::sort(pair.matches);
    }
    return all;
}

}  // namespace psfm
