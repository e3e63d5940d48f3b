// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/exchange/export_database.h"

#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "graph/wording.h"
#include "storage/exchange/database/colmap_database.h"
#include "storage/exchange/models/previous_export.h"
#include "storage/session/session_store.h"
#include "tools/commands/console/count_line.h"
#include "tools/commands/console/report_error.h"
#include "tools/commands/exchange/output_folder.h"

namespace psfm {
namespace {

struct Totals {
    std::size_t images = 0;
    std::size_t features = 0;
    std::size_t pairs = 0;
    std::size_t matches = 0;
};

struct DatabaseContents {
    std::vector<Image> images;
    std::vector<ImageSource> sources;  ///< beside them
    std::map<CameraId, Camera> cameras;
};

std::optional<Failure> write_images(const SessionReader& session, const DatabaseContents& contents,
                                    ColmapDatabaseWriter& writer, Totals& totals) {
    for (const auto& [id, camera] : contents.cameras) {
        if (auto done = writer.add_camera(id, camera); !done.ok()) return of_output(done.error());
    }
    CountLine line(" images written", contents.images.size());
    for (const Image& image : contents.images) {
        line.advance();
        if (contents.sources[index_of(image.id)].removed) continue;
        const auto keypoints = session.keypoints(image.id);
        if (!keypoints.ok()) return of_session(keypoints.error());
        const auto descriptors = session.descriptors(image.id);
        if (!descriptors.ok()) return of_session(descriptors.error());
        auto done = writer.add_image(image, **keypoints, **descriptors);
        if (!done.ok()) return of_output(done.error());
        ++totals.images;
        totals.features += (*keypoints)->size();
    }
    return std::nullopt;
}

std::optional<Failure> write_pairs(const SessionReader& session, const DatabaseContents& contents,
                                   ColmapDatabaseWriter& writer, Totals& totals) {
    const auto verified = session.verified_image_count();
    if (!verified.ok()) return of_session(verified.error());
    const auto camera_of = [&](ImageId image) -> const Camera& {
        return contents.cameras.at(contents.images[index_of(image)].camera);
    };
    CountLine line(" images with their pairs written", *verified);
    for (std::uint32_t i = 0; i < *verified; ++i) {
        const auto pairs = session.pairs_of(ImageId{i});
        if (!pairs.ok()) return of_session(pairs.error());
        for (const VerifiedPairPtr& pair : *pairs) {
            if (index_of(pair->pair.second) >= contents.images.size()) {
                return of_session(
                    {ErrorCode::kDamaged, "the session has a pair of image " +
                                              std::to_string(index_of(pair->pair.second)) +
                                              ", which it lacks; `psfm check` lists all damage"});
            }
            if (is_still_only(pair->geometry)) continue;
            auto done =
                writer.add_pair(*pair, camera_of(pair->pair.first), camera_of(pair->pair.second));
            if (!done.ok()) return of_output(done.error());
            totals.matches += pair->geometry.inliers.size();
            ++totals.pairs;
        }
        line.advance();
    }
    return std::nullopt;
}

std::optional<Failure> write_database(const SessionReader& session,
                                      const DatabaseContents& contents,
                                      const std::filesystem::path& file, Totals& totals) {
    auto previous = PreviousExport::take(file.parent_path());
    if (!previous.ok()) return of_output(previous.error());
    if (auto claimed = previous->claim(file); !claimed.ok()) return of_output(claimed.error());
    const auto writer = ColmapDatabaseWriter::create(file);
    if (!writer.ok()) return of_output(writer.error());
    if (auto failure = write_images(session, contents, **writer, totals)) return failure;
    if (auto failure = write_pairs(session, contents, **writer, totals)) return failure;
    if (auto announced = previous->announce(); !announced.ok()) return of_output(announced.error());
    if (auto done = (*writer)->finish(); !done.ok()) return of_output(done.error());
    StagedFiles none(file.parent_path());
    if (auto settled = previous->settle(none); !settled.ok()) return of_output(settled.error());
    return std::nullopt;
}

}  // namespace

int export_database(const std::string& session, const std::filesystem::path& folder) {
    const auto reader = open_session_reader(session, StoreOptions{});
    if (!reader.ok()) return report_error(reader.error());
    if (const auto apart = check_apart_from_photographs(folder, **reader, session); !apart.ok())
        return report_error(apart.error(), ErrorOrigin::kOtherInput);
    auto images = (*reader)->images();
    if (!images.ok()) return report_error(images.error());
    auto cameras = (*reader)->cameras();
    if (!cameras.ok()) return report_error(cameras.error());
    if (images->empty()) {
        return report_error({ErrorCode::kNotFound, session +
                                                       ": the session has no images yet; `psfm "
                                                       "status` says what it has seen"});
    }
    auto sources = (*reader)->image_sources();
    if (!sources.ok()) return report_error(sources.error());
    const DatabaseContents contents{*std::move(images), *std::move(sources), *std::move(cameras)};
    const std::filesystem::path file = folder / "database.db";
    Totals totals;
    if (const auto failure = write_database(**reader, contents, file, totals)) {
        return report_error(failure->error, failure->origin);
    }
    std::cout << file.string() << ": " << counted(totals.images, "image") << " of "
              << counted(contents.cameras.size(), "camera") << ", "
              << counted(totals.features, "feature") << ", "
              << counted(totals.pairs, "verified pair") << ", " << totals.matches
              << (totals.matches == 1 ? " match\n" : " matches\n") << std::flush;
    return 0;
}

}  // namespace psfm
