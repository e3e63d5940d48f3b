// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scheduler/flow/intake.h"

#include <memory>
#include <utility>

#include "scheduler/session/known_files.h"
#include "scheduler/session/remove_images.h"
#include "stages/features/cameras/assign_camera.h"

namespace psfm {

Result<AcceptedImagePtr> Intake::reject(const ExtractedMessage& message, const std::string& reason,
                                        std::uint64_t hash, const std::optional<FileStamp>& stamp) {
    RejectedPhoto rejected{message.file.name, reason, hash, -1};
    if (stamp) {
        rejected.file_size = stamp->size;
        rejected.file_time = stamp->modified_ns;
    }
    if (const auto stored = store_->commit_rejected(rejected); !stored.ok()) return stored.error();
    state_->photographs.rejected.insert(message.file.name);
    outbox_->tell_of_photo(SessionEvent::Kind::kRejected, message.file.name, reason);
    ++outbox_->images_released;
    return AcceptedImagePtr();
}

void Intake::pass_over(const ExtractedMessage& message) {
    ++outbox_->images_released;
    const std::string& name = message.file.name;
    if (!message.photo->ok()) return;  // it was read when it was accepted
    const auto twin =
        state_->photographs.image_of_content.find(message.photo->value().metadata.content_hash);
    if (twin != state_->photographs.image_of_content.end() &&
        state_->photographs.images[index_of(twin->second)].name == name)
        return;
    outbox_->tell_of_photo(
        SessionEvent::Kind::kRejected, name,
        name +
            " is another photograph than the one of that name which is in the session; "
            "give it a name of its own");
}

std::optional<CameraId> Intake::camera_of(const Image& image) {
    const CameraId next{state_->photographs.cameras.empty()
                            ? 0
                            : index_of(state_->photographs.cameras.rbegin()->first) + 1};
    const auto given = config_->given_cameras.find(image.name);
    if (given == config_->given_cameras.end()) {
        const CameraAssignment assignment = assign_camera(
            config_->camera_sharing, image.metadata, image.name, state_->photographs.camera_of_key,
            next, options_->features.unknown_focal);
        state_->photographs.camera_of_key.try_emplace(assignment.key, assignment.camera);
        if (assignment.added) state_->photographs.cameras[assignment.camera] = *assignment.added;
        return assignment.camera;
    }
    const Camera& camera = given->second.camera;
    if (camera.width != image.metadata.width || camera.height != image.metadata.height)
        return std::nullopt;
    const auto [entry, added] =
        state_->photographs.camera_of_key.try_emplace("given:" + given->second.key, next);
    if (added) state_->photographs.cameras[next] = camera;
    return entry->second;
}

Result<AcceptedImagePtr> Intake::take(const ExtractedMessage& message) {
    const std::string& name = message.file.name;
    if (state_->photographs.names.contains(name)) {
        pass_over(message);
        return AcceptedImagePtr();
    }
    if (!message.photo->ok()) {
        // What the system refuses now it may give the next time.
        const Error& error = message.photo->error();
        const bool is_its_content = error.code == ErrorCode::kUnreadable;
        return reject(message, error.message, 0, is_its_content ? message.stamp : std::nullopt);
    }
    const ExtractedPhoto& photo = message.photo->value();
    const std::uint64_t hash = photo.metadata.content_hash;
    if (state_->photographs.removed_content.contains(hash))
        return reject(message, removal_reason(name), hash, message.stamp);
    if (const auto twin = state_->photographs.image_of_content.find(hash);
        twin != state_->photographs.image_of_content.end())
        return meet_twin(message, twin->second);
    if (const std::string copy = small_copy_of_known(name, photo); !copy.empty())
        return reject(message, copy, hash, message.stamp);

    auto accepted = std::make_shared<AcceptedImage>();
    Image& image = accepted->image;
    image.id = static_cast<ImageId>(state_->photographs.images.size());
    image.name = name;
    image.metadata = photo.metadata;
    const auto camera = camera_of(image);
    if (!camera) {
        const Camera& given = config_->given_cameras.at(name).camera;
        return reject(message,
                      name + " is " + std::to_string(photo.metadata.width) + "x" +
                          std::to_string(photo.metadata.height) + " px, but its given camera is " +
                          std::to_string(given.width) + "x" + std::to_string(given.height) +
                          " px; correct cameras.txt",
                      hash, std::nullopt);
    }
    image.camera = *camera;
    accepted->camera = state_->photographs.cameras.at(image.camera);
    accepted->view_graph = state_->view_graph;
    ImageSource source;
    source.signature = photo.signature;
    source.mask_hash = photo.mask_hash;
    if (message.stamp) source.file = file_of(message.file, *message.stamp);
    // Aliased pointers: keypoints and descriptors live as long as the extracted photograph.
    accepted->keypoints = {message.photo, &photo.keypoints};
    accepted->descriptors = {message.photo, &photo.descriptors};
    if (const auto stored = store_->commit_image(image, accepted->camera, photo.keypoints,
                                                 photo.descriptors, source);
        !stored.ok())
        return stored.error();

    state_->photographs.images.push_back(image);
    state_->photographs.sources.push_back(std::move(source));
    state_->photographs.keypoints.push_back(std::make_shared<const Keypoints>(photo.keypoints));
    state_->photographs.image_of_content.emplace(hash, image.id);
    state_->photographs.names.insert(image.name);
    state_->photographs.rejected.erase(image.name);
    reports_->accept(image, message.arrival, message.extract_ms);
    for (const std::string& remark : photo.remarks)
        outbox_->tell_of_photo(SessionEvent::Kind::kRemark, name, remark);
    tell_of_small_copies(image.id);
    return AcceptedImagePtr(std::move(accepted));
}

}  // namespace psfm
