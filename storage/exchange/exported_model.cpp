// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/exported_model.h"

#include <algorithm>

namespace psfm {
namespace {

template <typename Item, typename Id>
const Item* find_by_id(const std::vector<Item>& items, Id id) {
    const auto found = std::ranges::lower_bound(items, id, {}, &Item::id);
    return found != items.end() && found->id == id ? &*found : nullptr;
}

}  // namespace

const ExportedCamera* ExportedModel::find_camera(std::uint32_t id) const {
    return find_by_id(cameras, id);
}

const ExportedImage* ExportedModel::find_image(std::uint32_t id) const {
    return find_by_id(images, id);
}

const ExportedPoint* ExportedModel::find_point(std::uint64_t id) const {
    return find_by_id(points, id);
}

}  // namespace psfm
