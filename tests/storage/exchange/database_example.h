// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// COLMAP databases that the tests write, and change with SQL.

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "storage/exchange/database/colmap_database.h"
#include "tests/synthetic/rng.h"

namespace psfm::test {

/// What a database holds.
struct DatabaseContents {
    std::map<CameraId, Camera> cameras;
    std::vector<Image> images;
    std::vector<Keypoints> keypoints;
    std::vector<Descriptors> descriptors;  ///< some are empty
    std::vector<VerifiedPair> pairs;
};

/// Random values, a camera of each model, every kind of geometry in turn. Names are not in the
/// order of ids.
inline DatabaseContents random_contents(std::uint32_t images, std::uint64_t seed) {
    synthetic::Rng rng(seed);
    DatabaseContents contents;
    for (std::uint32_t i = 0; i < 5; ++i) {
        Camera camera = make_camera(1200 + i, 800, 1000.0 + 50.0 * rng.uniform(),
                                    i % 2 == 0 ? FocalSource::kUnknown : FocalSource::kExif);
        camera.model = static_cast<CameraModel>(i);
        camera.params = {};
        for (int k = 0; k < parameter_count(camera.model); ++k) {
            camera.params[static_cast<std::size_t>(k)] = rng.uniform(300.0, 2000.0);
        }
        contents.cameras.emplace(CameraId{i}, camera);
    }
    for (std::uint32_t i = 0; i < images; ++i) {
        Image image;
        image.id = ImageId{i};
        image.camera = CameraId{i % 5};
        image.metadata.width = contents.cameras.at(image.camera).width;
        image.metadata.height = contents.cameras.at(image.camera).height;
        image.name = "folder " + std::to_string(rng.below(1000)) + "/b'ü" + std::to_string(i);
        contents.images.push_back(image);
        Keypoints keypoints(20 + rng.below(30));
        for (Keypoint& keypoint : keypoints) {
            keypoint.x = static_cast<float>(rng.uniform(0, 1200));
            keypoint.y = static_cast<float>(rng.uniform(0, 800));
            keypoint.scale = static_cast<float>(rng.uniform(1, 20));
            keypoint.angle = static_cast<float>(rng.uniform(-3, 3));
        }
        Descriptors descriptors;
        if (i % 4 != 3) descriptors.values.resize(keypoints.size() * Descriptors::kSize);
        for (auto& value : descriptors.values) value = static_cast<std::uint8_t>(rng.below(256));
        contents.keypoints.push_back(keypoints);
        contents.descriptors.push_back(descriptors);
    }
    for (std::uint32_t a = 0; a < images; ++a) {
        for (std::uint32_t b = a + 1; b < images; ++b) {
            if (rng.uniform() < 0.3) continue;
            VerifiedPair pair;
            pair.pair = {ImageId{a}, ImageId{b}};
            pair.geometry.kind = static_cast<TwoViewKind>((a + b) % 4);
            pair.geometry.matrix = Eigen::Matrix3d::NullaryExpr([&] { return rng.normal(); });
            pair.geometry.cam2_from_cam1 = {rng.rotation(), rng.direction()};
            auto seconds = synthetic::random_order(contents.keypoints[b].size(), rng.bits());
            for (std::uint32_t i = 0; i < contents.keypoints[a].size() && i < seconds.size(); ++i) {
                if (rng.uniform() < 0.5) continue;
                pair.geometry.inliers.push_back({i, static_cast<std::uint32_t>(seconds[i])});
            }
            if (!pair.geometry.inliers.empty()) contents.pairs.push_back(pair);
        }
    }
    return contents;
}

inline Result<void> write_database(const DatabaseContents& contents,
                                   const std::filesystem::path& file) {
    const auto writer = ColmapDatabaseWriter::create(file);
    if (!writer) return writer.error();
    for (const auto& [id, camera] : contents.cameras) {
        if (auto done = (*writer)->add_camera(id, camera); !done) return done;
    }
    for (std::size_t i = 0; i < contents.images.size(); ++i) {
        auto done = (*writer)->add_image(contents.images[i], contents.keypoints[i],
                                         contents.descriptors[i]);
        if (!done) return done;
    }
    for (const VerifiedPair& pair : contents.pairs) {
        const auto camera_of = [&](ImageId image) {
            return contents.cameras.at(contents.images[index_of(image)].camera);
        };
        auto done =
            (*writer)->add_pair(pair, camera_of(pair.pair.first), camera_of(pair.pair.second));
        if (!done) return done;
    }
    return (*writer)->finish();
}

/// Runs SQL on a database that it makes if need be. Constraints can be broken: nothing is checked.
inline void run_sql(const std::filesystem::path& file, const std::string& sql) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database) << ": " << sql;
    sqlite3_close(database);
}

/// The first value that a query gives, as text; "" for none.
inline std::string ask_sql(const std::filesystem::path& file, const std::string& sql) {
    sqlite3* database = nullptr;
    sqlite3_stmt* statement = nullptr;
    std::string answer;
    sqlite3_open(file.c_str(), &database);
    EXPECT_EQ(sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database) << ": " << sql;
    if (sqlite3_step(statement) == SQLITE_ROW) {
        const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement, 0));
        if (bytes != nullptr) {
            answer.assign(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement, 0)));
        }
    }
    sqlite3_finalize(statement);
    sqlite3_close(database);
    return answer;
}

/// SQL's literal for a blob of these numbers.
template <typename T>
std::string blob_literal(const std::vector<T>& values) {
    std::string literal = "x'";
    for (const T& value : values) {
        unsigned char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        for (const unsigned char byte : bytes) {
            literal.push_back("0123456789abcdef"[byte >> 4U]);
            literal.push_back("0123456789abcdef"[byte & 15U]);
        }
    }
    return literal + "'";
}

}  // namespace psfm::test
