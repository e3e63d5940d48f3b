// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <optional>
#include <set>
#include <utility>

#include "storage/exchange/database/colmap_database.h"
#include "storage/exchange/database/database_blocks.h"
#include "storage/exchange/files/image_name.h"
#include "storage/exchange/files/output_file.h"
#include "storage/exchange/files/sqlite_statement.h"

namespace psfm {

struct ColmapDatabaseWriter::Connection {
    Connection() = default;
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;
    ~Connection() {
        std::error_code ignored;
        if (!temporary.empty()) std::filesystem::remove(temporary, ignored);
    }

    Result<void> open(const std::filesystem::path& path);
    Error refused(const std::string& problem) const {
        return {ErrorCode::kInvalidArgument, file.string() + ": " + problem};
    }
    Result<void> write_camera(CameraId id, const Camera& value);
    Result<void> write_image(const Image& value, const Keypoints& places, const Descriptors& rows);
    Result<void> write_pair(const VerifiedPair& value, const Camera& camera1,
                            const Camera& camera2);
    Result<void> finish();
    /// Without a journal nothing can be taken back: after a failure, finish() fails, too.
    Result<void> kept(const Result<void>& done) {
        if (!done.ok() && !failure) failure = done.error();
        return done;
    }

    std::filesystem::path file;
    std::filesystem::path temporary;  ///< removed at the end, unless empty
    std::set<std::uint32_t> cameras;
    std::map<std::uint32_t, std::size_t> features;  ///< how many, by image
    std::optional<Error> failure;                   ///< the first

    // Statements end before their connection does.
    SqliteConnection database;
    SqliteStatement camera, image, keypoints, descriptors, matches, geometry;
};

namespace {

using Bytes = std::vector<std::byte>;

/// COLMAP 3.8's tables and version number; later versions bring a database up to date from there.
constexpr const char* kSchema =
    "CREATE TABLE cameras (camera_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,"
    " model INTEGER NOT NULL, width INTEGER NOT NULL, height INTEGER NOT NULL, params BLOB,"
    " prior_focal_length INTEGER NOT NULL);"
    "CREATE TABLE images (image_id INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL,"
    " name TEXT NOT NULL UNIQUE, camera_id INTEGER NOT NULL, prior_qw REAL, prior_qx REAL,"
    " prior_qy REAL, prior_qz REAL, prior_tx REAL, prior_ty REAL, prior_tz REAL,"
    " CONSTRAINT image_id_check CHECK(image_id >= 0 and image_id < 2147483647),"
    " FOREIGN KEY(camera_id) REFERENCES cameras(camera_id));"
    "CREATE UNIQUE INDEX index_name ON images(name);"
    "CREATE TABLE keypoints (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,"
    " cols INTEGER NOT NULL, data BLOB,"
    " FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);"
    "CREATE TABLE descriptors (image_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,"
    " cols INTEGER NOT NULL, data BLOB,"
    " FOREIGN KEY(image_id) REFERENCES images(image_id) ON DELETE CASCADE);"
    "CREATE TABLE matches (pair_id INTEGER PRIMARY KEY NOT NULL, rows INTEGER NOT NULL,"
    " cols INTEGER NOT NULL, data BLOB);"
    "CREATE TABLE two_view_geometries (pair_id INTEGER PRIMARY KEY NOT NULL,"
    " rows INTEGER NOT NULL, cols INTEGER NOT NULL, data BLOB, config INTEGER NOT NULL,"
    " F BLOB, E BLOB, H BLOB, qvec BLOB, tvec BLOB);"
    "PRAGMA user_version=3800; BEGIN";

/// Changes that another program has not brought into the file yet. They would be brought into the
/// new file, and ruin it.
Result<void> check_nobody_writes(const std::filesystem::path& file) {
    for (const char* ending : {"-wal", "-journal"}) {
        std::error_code ignored;
        const std::filesystem::path pending = file.string() + ending;
        if (!std::filesystem::exists(pending, ignored)) continue;
        if (std::filesystem::file_size(pending, ignored) == 0) continue;
        return Error{ErrorCode::kUnreadable,
                     file.string() +
                         " is being written by another program, or was left unfinished "
                         "by it (" +
                         pending.filename().string() +
                         " is there): close that program, or choose another folder"};
    }
    return {};
}

Result<void> sync_to_device(const std::filesystem::path& temporary,
                            const std::filesystem::path& file) {
    const int descriptor = ::open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return file_error(file, errno);
    const int failure = fsync(descriptor) == 0 ? 0 : errno;
    ::close(descriptor);
    if (failure != 0 && failure != EINVAL && failure != EROFS) return file_error(file, failure);
    return {};
}

Bytes bytes_of(const Keypoints& keypoints) {
    Bytes bytes;
    bytes.reserve(keypoints.size() * 4 * sizeof(float));
    for (const Keypoint& keypoint : keypoints) {
        for (const float value : {keypoint.x, keypoint.y, keypoint.scale, keypoint.angle}) {
            colmap::append_little_endian(bytes, value);
        }
    }
    return bytes;
}

Bytes bytes_of(const std::vector<FeatureMatch>& matches) {
    Bytes bytes;
    bytes.reserve(matches.size() * 2 * sizeof(std::uint32_t));
    for (const FeatureMatch& match : matches) {
        colmap::append_little_endian(bytes, match.first);
        colmap::append_little_endian(bytes, match.second);
    }
    return bytes;
}

/// Row after row.
Bytes bytes_of(const Eigen::Matrix3d& matrix) {
    Bytes bytes;
    for (int row = 0; row < 3; ++row) {
        for (int col = 0; col < 3; ++col) colmap::append_little_endian(bytes, matrix(row, col));
    }
    return bytes;
}

Bytes bytes_of(std::initializer_list<double> values) {
    Bytes bytes;
    for (const double value : values) colmap::append_little_endian(bytes, value);
    return bytes;
}

/// What COLMAP stores of a pair's geometry; a matrix that the pair does not have is zero.
struct Geometry {
    colmap::PairConfig config = colmap::PairConfig::kUndefined;
    Eigen::Matrix3d fundamental = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d essential = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d homography = Eigen::Matrix3d::Zero();
};

/// [t]x R. Hartley and Zisserman, Multiple View Geometry, 2nd edition, eq. 9.12.
Eigen::Matrix3d essential_of(const Rigid3& cam2_from_cam1) {
    const Eigen::Vector3d& t = cam2_from_cam1.translation;
    Eigen::Matrix3d cross;
    cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
    const Eigen::Matrix3d essential = cross * cam2_from_cam1.rotation.toRotationMatrix();
    return essential;
}

/// K2^-T E K1^-1, Frobenius norm 1 (eq. 9.12 solved for F); zero for a zero E.
Eigen::Matrix3d fundamental_of(const Eigen::Matrix3d& essential, const Camera& camera1,
                               const Camera& camera2) {
    Eigen::Matrix3d fundamental =
        camera2.matrix().inverse().transpose() * essential * camera1.matrix().inverse();
    const double norm = fundamental.norm();
    if (norm > 0.0) fundamental /= norm;
    return fundamental;
}

Geometry geometry_of(const TwoViewGeometry& pair, const Camera& camera1, const Camera& camera2) {
    Geometry geometry;
    switch (pair.kind) {
        case TwoViewKind::kEssential:
            geometry.config = colmap::PairConfig::kCalibrated;
            geometry.essential = pair.matrix;
            geometry.fundamental = fundamental_of(pair.matrix, camera1, camera2);
            break;
        case TwoViewKind::kFundamental:
            geometry.config = colmap::PairConfig::kUncalibrated;
            geometry.fundamental = pair.matrix;
            break;
        case TwoViewKind::kPlanar:
            geometry.config = colmap::PairConfig::kPlanar;
            geometry.homography = pair.matrix;
            geometry.essential = essential_of(pair.cam2_from_cam1);
            geometry.fundamental = fundamental_of(geometry.essential, camera1, camera2);
            break;
        case TwoViewKind::kPureRotation:
            geometry.config = colmap::PairConfig::kPanoramic;
            geometry.homography = pair.matrix;
            break;
    }
    return geometry;
}

}  // namespace

Result<void> ColmapDatabaseWriter::Connection::open(const std::filesystem::path& path) {
    file = path;
    if (auto checked = check_nobody_writes(file); !checked.ok()) return checked.error();
    const std::filesystem::path partial = file.string() + ".partial";
    std::error_code code;
    std::filesystem::remove(partial, code);
    if (code) return file_error(partial, code.value());
    temporary = partial;
    if (auto made = database.create(partial, file); !made.ok()) return made.error();
    if (auto made = database.execute(kSchema); !made.ok()) return made.error();
    const std::pair<SqliteStatement*, const char*> statements[] = {
        {&camera, "INSERT INTO cameras VALUES(?1,?2,?3,?4,?5,?6)"},
        {&image, "INSERT INTO images(image_id,name,camera_id) VALUES(?1,?2,?3)"},
        {&keypoints, "INSERT INTO keypoints VALUES(?1,?2,?3,?4)"},
        {&descriptors, "INSERT INTO descriptors VALUES(?1,?2,?3,?4)"},
        {&matches, "INSERT INTO matches VALUES(?1,?2,?3,?4)"},
        {&geometry, "INSERT INTO two_view_geometries VALUES(?1,?2,?3,?4,?5,?6,?7,?8,?9,?10)"},
    };
    for (const auto& [statement, sql] : statements) {
        auto prepared = database.prepare(sql);
        if (!prepared.ok()) return prepared.error();
        *statement = *std::move(prepared);
    }
    return {};
}

Result<void> ColmapDatabaseWriter::Connection::write_camera(CameraId id, const Camera& value) {
    const std::uint32_t number = index_of(id) + 1;
    if (auto valid = validate(value); !valid.ok()) {
        return refused("camera " + std::to_string(number) + ": " + valid.error().message);
    }
    Bytes params;
    for (int i = 0; i < parameter_count(value.model); ++i) {
        colmap::append_little_endian(params, value.params[static_cast<std::size_t>(i)]);
    }
    cameras.insert(number);
    return camera.bind(1, std::int64_t{number})
        .bind(2, static_cast<std::int64_t>(value.model))
        .bind(3, std::int64_t{value.width})
        .bind(4, std::int64_t{value.height})
        .bind(5, params)
        .bind(6, std::int64_t{value.focal_source != FocalSource::kUnknown})
        .run();
}

Result<void> ColmapDatabaseWriter::Connection::write_image(const Image& value,
                                                           const Keypoints& places,
                                                           const Descriptors& rows) {
    const std::int64_t id = std::int64_t{index_of(value.id)} + 1;
    const std::uint32_t camera_id = index_of(value.camera) + 1;
    if (id >= colmap::kMaxImages) return refused("COLMAP has no ids for more images");
    if (!cameras.contains(camera_id)) {
        return refused(value.name + ": its camera was not added before it");
    }
    if (const auto problem = problem_of_name(value.name)) {
        return refused("the name of image " + std::to_string(id) + " " + *problem);
    }
    if (rows.rows() != 0 && rows.rows() != places.size()) {
        return refused(value.name + ": as many descriptors as features are wanted");
    }
    auto written = image.bind(1, id).bind(2, value.name).bind(3, std::int64_t{camera_id}).run();
    if (!written) return written;
    features[static_cast<std::uint32_t>(id)] = places.size();
    const Bytes bytes = bytes_of(places);
    written = keypoints.bind(1, id)
                  .bind(2, static_cast<std::int64_t>(places.size()))
                  .bind(3, std::int64_t{4})
                  .bind(4, bytes)
                  .run();
    if (!written || rows.values.empty()) return written;
    return descriptors.bind(1, id)
        .bind(2, static_cast<std::int64_t>(rows.rows()))
        .bind(3, static_cast<std::int64_t>(Descriptors::kSize))
        .bind(4, std::as_bytes(std::span(rows.values)))
        .run();
}

Result<void> ColmapDatabaseWriter::Connection::write_pair(const VerifiedPair& value,
                                                          const Camera& camera1,
                                                          const Camera& camera2) {
    const std::uint32_t first = index_of(value.pair.first) + 1;
    const std::uint32_t second = index_of(value.pair.second) + 1;
    const std::string who =
        "the pair of images " + std::to_string(first) + " and " + std::to_string(second);
    const auto features1 = features.find(first);
    const auto features2 = features.find(second);
    if (features1 == features.end() || features2 == features.end() || first >= second) {
        return refused(who + ": the images were not added before it");
    }
    for (const FeatureMatch& match : value.geometry.inliers) {
        if (match.first >= features1->second || match.second >= features2->second) {
            return refused(who + " matches features that are not there");
        }
    }
    const Bytes bytes = bytes_of(value.geometry.inliers);
    const auto put_matches = [&](SqliteStatement& statement) -> SqliteStatement& {
        return statement.bind(1, colmap::pair_key(first, second))
            .bind(2, static_cast<std::int64_t>(value.geometry.inliers.size()))
            .bind(3, std::int64_t{2})
            .bind(4, bytes);
    };
    if (auto written = put_matches(matches).run(); !written.ok()) return written.error();

    const Geometry parts = geometry_of(value.geometry, camera1, camera2);
    const Bytes fundamental = bytes_of(parts.fundamental);
    const Bytes essential = bytes_of(parts.essential);
    const Bytes homography = bytes_of(parts.homography);
    const Rigid3& pose = value.geometry.cam2_from_cam1;
    const Bytes rotation =
        bytes_of({pose.rotation.w(), pose.rotation.x(), pose.rotation.y(), pose.rotation.z()});
    const Bytes translation =
        bytes_of({pose.translation.x(), pose.translation.y(), pose.translation.z()});
    return put_matches(geometry)
        .bind(5, static_cast<std::int64_t>(parts.config))
        .bind(6, fundamental)
        .bind(7, essential)
        .bind(8, homography)
        .bind(9, rotation)
        .bind(10, translation)
        .run();
}

Result<void> ColmapDatabaseWriter::Connection::finish() {
    if (failure) return *failure;
    if (auto done = database.execute("COMMIT"); !done.ok()) return done.error();
    for (SqliteStatement* statement :
         {&camera, &image, &keypoints, &descriptors, &matches, &geometry}) {
        *statement = SqliteStatement();
    }
    if (auto done = database.close(); !done.ok()) return done.error();
    if (auto done = sync_to_device(temporary, file); !done.ok()) return done.error();
    if (auto checked = check_nobody_writes(file); !checked.ok()) return checked.error();
    std::error_code code;
    std::filesystem::rename(temporary, file, code);
    if (code) return file_error(file, code.value());
    temporary.clear();
    return {};
}

ColmapDatabaseWriter::ColmapDatabaseWriter() : connection_(std::make_unique<Connection>()) {}
ColmapDatabaseWriter::~ColmapDatabaseWriter() = default;

Result<std::unique_ptr<ColmapDatabaseWriter>> ColmapDatabaseWriter::create(
    const std::filesystem::path& file) {
    std::unique_ptr<ColmapDatabaseWriter> writer(new ColmapDatabaseWriter);
    if (auto opened = writer->connection_->open(file); !opened.ok()) return opened.error();
    return writer;
}

Result<void> ColmapDatabaseWriter::add_camera(CameraId id, const Camera& camera) {
    return connection_->kept(connection_->write_camera(id, camera));
}

Result<void> ColmapDatabaseWriter::add_image(const Image& image, const Keypoints& keypoints,
                                             const Descriptors& descriptors) {
    return connection_->kept(connection_->write_image(image, keypoints, descriptors));
}

Result<void> ColmapDatabaseWriter::add_pair(const VerifiedPair& pair, const Camera& camera1,
                                            const Camera& camera2) {
    return connection_->kept(connection_->write_pair(pair, camera1, camera2));
}

Result<void> ColmapDatabaseWriter::finish() {
    return connection_->kept(connection_->finish());
}

}  // namespace psfm
