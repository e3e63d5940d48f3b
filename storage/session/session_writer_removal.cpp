// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The session's writer where images are taken out again.
#include "storage/records/image_records.h"
#include "storage/records/pair_records.h"
#include "storage/session/session_writer.h"
#include "storage/session/writer_batch.h"

namespace psfm {

Result<void> SessionWriter::commit_removal(const StoredRemoval& removal) {
    auto edited = edited_clusters(removal.edit);
    if (!edited.ok()) return edited.error();
    Batch batch(database());
    for (const auto& [image, source] : removal.images) {
        if (index_of(image.id) >= state_.image_count)
            return refused("an image is removed that was not accepted");
        const std::string key = encode_key(image.id);
        batch.put(Family::kImages, RecordKind::kImage, key, encode_image(image, source));
        // Keypoints stay: what older versions keep refers to them.
        batch.put(Family::kDescriptors, RecordKind::kDescriptors, key, encode_descriptors({}));
    }
    for (const auto& [image, pairs] : removal.pairs) {
        if (index_of(image) >= state_.verified_count)
            return refused("pairs are changed of an image that has none");
        batch.put(Family::kPairs, RecordKind::kPairs, encode_key(image),
                  encode_pairs(image, pairs));
    }
    for (const RejectedPhoto& photo : removal.rejected) {
        batch.put(Family::kMeta, RecordKind::kRejected, rejected_key(photo.name),
                  encode_rejected(photo));
    }
    SupersededSolutions marked;
    put_clusters(batch, *edited, marked);
    if (auto written = write(batch); !written.ok()) return written.error();
    take_over(*std::move(edited), marked);
    for (const SourcedImage& removed : removal.images) forget_descriptors(removed.image.id);
    return {};
}

Result<void> SessionWriter::forget_rejected(const std::vector<std::string>& names) {
    Batch batch(database());
    for (const std::string& name : names) batch.remove(Family::kMeta, rejected_key(name));
    return write(batch);
}

}  // namespace psfm
