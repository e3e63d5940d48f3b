// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Photographs that are the same as others: moved, copied, reduced.
#include <filesystem>
#include <string>
#include <utility>

#include "scheduler/flow/intake.h"
#include "scheduler/session/known_files.h"
#include "stages/features/photographs/reduced_copy.h"

namespace psfm {
namespace {

std::string size_text(const PhotoMetadata& photo) {
    return std::to_string(photo.width) + "x" + std::to_string(photo.height) + " px";
}

Glance glance_of(const PhotoMetadata& photo, const std::vector<std::uint8_t>& signature) {
    return {photo.width, photo.height, photo.orientation, signature};
}

}  // namespace

Result<AcceptedImagePtr> Intake::meet_twin(const ExtractedMessage& message, ImageId twin) {
    const std::string& name = message.file.name;
    Image& image = state_->photographs.images[index_of(twin)];
    ImageSource& source = state_->photographs.sources[index_of(twin)];
    const std::filesystem::path folder = source.file.folder;
    const bool has_moved = !folder.empty() && is_gone(folder / image.name);
    if (!has_moved || !message.stamp) {
        return reject(message,
                      name + " is a byte-for-byte copy of " + image.name +
                          ", which is in the session; delete one of the two",
                      message.photo->value().metadata.content_hash, message.stamp);
    }
    SourcedImage moved{image, source};
    moved.image.name = name;
    moved.source.file = file_of(message.file, *message.stamp);
    if (const auto stored = store_->commit_files({moved}); !stored.ok()) return stored.error();
    outbox_->tell_of_photo(SessionEvent::Kind::kRemark, name,
                           image.name + " was moved or renamed, and is " + name + " now");
    state_->photographs.names.erase(image.name);
    state_->photographs.names.insert(name);
    state_->photographs.rejected.erase(name);
    image = std::move(moved.image);
    source = std::move(moved.source);
    ++outbox_->images_released;
    return AcceptedImagePtr();
}

std::string Intake::small_copy_of_known(const std::string& name,
                                        const ExtractedPhoto& photo) const {
    const Glance glance = glance_of(photo.metadata, photo.signature);
    for (const Image& image : state_->photographs.images) {
        const ImageSource& source = state_->photographs.sources[index_of(image.id)];
        if (source.removed || !is_reduced_copy(glance, glance_of(image.metadata, source.signature),
                                               options_->features.small_copies))
            continue;
        return name + " (" + size_text(photo.metadata) + ") is a small copy of " + image.name +
               " (" + size_text(image.metadata) + "), which is in the session; leave it out";
    }
    return {};
}

void Intake::tell_of_small_copies(ImageId id) {
    const Image& image = state_->photographs.images[index_of(id)];
    const Glance glance =
        glance_of(image.metadata, state_->photographs.sources[index_of(id)].signature);
    for (const Image& other : state_->photographs.images) {
        const ImageSource& source = state_->photographs.sources[index_of(other.id)];
        if (source.removed || !is_reduced_copy(glance_of(other.metadata, source.signature), glance,
                                               options_->features.small_copies))
            continue;
        outbox_->tell_of_photo(SessionEvent::Kind::kRemark, image.name,
                               other.name + " is a small copy of " + image.name +
                                   " and came before it; take it out with 'psfm remove'");
    }
}

}  // namespace psfm
