// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "graph/reconstruction.h"

#include <algorithm>
#include <utility>

namespace psfm {

const RegisteredImage* Reconstruction::find(ImageId image) const {
    const auto found = std::ranges::lower_bound(images, image, {}, &RegisteredImage::image);
    return found != images.end() && found->image == image ? &*found : nullptr;
}

Succession compose(const Succession& first, const Succession& later) {
    Succession whole = first;
    std::size_t between = 0;  // points of the model between, which come in the order of the first
    for (std::uint8_t& replaced : whole.replaced) {
        if (replaced == 0) replaced = later.replaced[between++];
    }
    return whole;
}

Reconstruction restricted_to(const Reconstruction& model, std::span<const ImageId> keep) {
    const auto kept = [&](ImageId image) { return std::ranges::binary_search(keep, image); };
    Reconstruction part;
    for (const RegisteredImage& image : model.images) {
        if (!kept(image.image)) continue;
        part.images.push_back(image);
        part.cameras[image.camera] = model.cameras.at(image.camera);
    }
    std::vector<ScenePoint> points;
    for (const PointBlockPtr& block : model.points.blocks()) {
        if (std::ranges::includes(keep, block->images())) {
            part.points.append(std::exchange(points, {}));
            part.points.append(block);
            continue;
        }
        for (const ScenePoint& point : block->points()) {
            ScenePoint seen = point;
            std::erase_if(seen.track, [&](const Observation& o) { return !kept(o.image); });
            if (seen.track.size() >= 2) points.push_back(std::move(seen));
        }
    }
    part.points.append(std::move(points));
    return part;
}

bool places_others_than(const Reconstruction& model, std::span<const ImageId> images) {
    return !std::ranges::includes(images, model.images, {}, {}, &RegisteredImage::image);
}

}  // namespace psfm
