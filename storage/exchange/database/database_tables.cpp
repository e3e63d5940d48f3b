// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/database/database_tables.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "storage/exchange/database/database_blocks.h"
#include "storage/exchange/files/image_name.h"
#include "storage/exchange/files/sqlite_file.h"
#include "storage/exchange/models/read_colmap_parts.h"

namespace psfm::colmap {
namespace {

struct Table {
    std::string name;
    std::vector<std::string> columns;
};

/// What is read, of what COLMAP writes.
const std::vector<Table>& tables() {
    static const std::vector<Table> all{
        {"cameras", {"camera_id", "model", "width", "height", "params", "prior_focal_length"}},
        {"images", {"image_id", "name", "camera_id"}},
        {"keypoints", {"image_id", "rows", "cols", "data"}},
        {"descriptors", {"image_id", "rows", "cols", "data"}},
        {"two_view_geometries", {"pair_id", "rows", "cols", "data", "config"}},
    };
    return all;
}

/// An id of a table's own or of another's: 1 … 2^31 - 2. @param what  whose
Result<std::uint32_t> id_at(const SqliteConnection& database, const SqliteStatement& row,
                            int column, const std::string& what) {
    const auto id = row.integer(column);
    if (id && *id > 0 && *id < kMaxImages) return static_cast<std::uint32_t>(*id);
    return damaged_database(database.path(), what + " has an id that is none");
}

Result<std::pair<std::uint32_t, Camera>> camera_of(const SqliteConnection& database,
                                                   const SqliteStatement& row) {
    const auto id = id_at(database, row, 0, "a camera");
    if (!id.ok()) return id.error();
    const auto damaged = [&](const std::string& problem) {
        return damaged_database(database.path(), "camera " + std::to_string(*id) + ": " + problem);
    };
    const auto model = row.integer(1);
    constexpr std::int64_t kLastRead = 4;    // Format: COLMAP's number of kOpenCv
    constexpr std::int64_t kLastKnown = 17;  // Format: of its last model; beyond there is none
    if (!model || *model < 0 || *model > kLastKnown) return damaged("unknown camera model");
    if (*model > kLastRead) {
        return unsupported_model(database.path(), *id, "number " + std::to_string(*model));
    }
    const auto width = row.integer(2);
    const auto height = row.integer(3);
    if (!width || !height || *width < 1 || *height < 1 || *width > INT32_MAX ||
        *height > INT32_MAX) {
        return damaged("its size is none");
    }
    Camera camera;
    camera.model = static_cast<CameraModel>(*model);
    camera.width = static_cast<std::uint32_t>(*width);
    camera.height = static_cast<std::uint32_t>(*height);
    camera.focal_source =
        row.integer(5).value_or(0) != 0 ? FocalSource::kExif : FocalSource::kUnknown;
    const auto params = row.blob(4);
    const auto count = static_cast<std::size_t>(parameter_count(camera.model));
    if (!params || params->size() != count * sizeof(double)) {
        return damaged("its parameters are not " + std::to_string(count) + " numbers");
    }
    for (std::size_t i = 0; i < count; ++i) camera.params[i] = little_endian_at<double>(*params, i);
    if (auto valid = validate(camera); !valid.ok()) return damaged(valid.error().message);
    return std::pair(*id, camera);
}

}  // namespace

Result<void> check_tables(SqliteConnection& database) {
    for (const Table& table : tables()) {
        bool stored = false;
        std::vector<std::string> columns;
        auto looked = for_each_row(
            database,
            "SELECT 1 FROM sqlite_master WHERE type='table' AND rootpage>0 AND name='" +
                table.name + "'",
            [&](const SqliteStatement&) {
                stored = true;
                return Result<void>{};
            });
        if (!looked.ok()) return looked.error();
        looked = for_each_row(database, "SELECT name FROM pragma_table_info('" + table.name + "')",
                              [&](const SqliteStatement& row) {
                                  columns.emplace_back(row.text(0).value_or(""));
                                  return Result<void>{};
                              });
        if (!looked.ok()) return looked.error();
        if (!stored) {
            return damaged_database(database.path(), "no database of COLMAP's, the table " +
                                                         table.name + " is missing");
        }
        for (const std::string& column : table.columns) {
            if (std::ranges::find(columns, column) != columns.end()) continue;
            return damaged_database(database.path(),
                                    "the table " + table.name + " has no column " + column);
        }
    }
    return {};
}

Result<std::map<std::uint32_t, Camera>> read_cameras(SqliteConnection& database) {
    std::map<std::uint32_t, Camera> cameras;
    auto read = for_each_row(
        database,
        "SELECT camera_id,model,width,height,CASE WHEN length(params)<=64 THEN params END,"
        "prior_focal_length FROM cameras",
        [&](const SqliteStatement& row) -> Result<void> {
            const auto camera = camera_of(database, row);
            if (!camera.ok()) return camera.error();
            if (cameras.insert(*camera).second) return {};
            return damaged_database(database.path(),
                                    "camera " + std::to_string(camera->first) + " is there twice");
        });
    if (!read.ok()) return read.error();
    return cameras;
}

Result<std::vector<DatabaseImage>> read_images(SqliteConnection& database,
                                               const std::map<std::uint32_t, Camera>& cameras) {
    std::vector<DatabaseImage> images;
    auto read = for_each_row(
        database, "SELECT image_id,name,camera_id FROM images",
        [&](const SqliteStatement& row) -> Result<void> {
            const auto id = id_at(database, row, 0, "an image");
            if (!id.ok()) return id.error();
            const std::string who = "image " + std::to_string(*id);
            const auto camera = id_at(database, row, 2, "the camera of " + who);
            if (!camera.ok()) return camera.error();
            const auto name = row.text(1);
            if (!name) return damaged_database(database.path(), who + " has no name");
            if (const auto problem = problem_of_name(*name)) {
                return damaged_database(database.path(), "the name of " + who + " " + *problem);
            }
            if (!cameras.contains(*camera)) {
                return damaged_database(
                    database.path(),
                    who + " has camera " + std::to_string(*camera) + ", which is not there");
            }
            images.push_back({*id, *camera, std::string(*name)});
            return {};
        });
    if (!read.ok()) return read.error();
    std::ranges::sort(images, {}, &DatabaseImage::name);
    const auto twice = std::ranges::adjacent_find(images, {}, &DatabaseImage::name);
    if (twice != images.end()) {
        return damaged_database(database.path(), "two images have the name " + twice->name);
    }
    return images;
}

}  // namespace psfm::colmap
