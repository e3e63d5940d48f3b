// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/exchange/models/dataset_names.h"

#include <filesystem>
#include <map>
#include <set>
#include <string_view>

namespace psfm {
namespace {

/// Longer names leave file systems no room for endings (255 bytes); the end tells more than the
/// folders at the beginning. Names stay UTF-8.
void shorten(std::string& name) {
    constexpr std::size_t kMost = 200;  // Guard: [bytes], below the 255 of file systems
    if (name.size() <= kMost) return;
    std::size_t from = name.size() - kMost;
    while (from < name.size() && (static_cast<unsigned char>(name[from]) & 0xC0U) == 0x80U) ++from;
    name.erase(0, from);
}

std::string flattened(const std::string& photo_name) {
    std::string name = std::filesystem::path(photo_name).replace_extension().generic_string();
    constexpr std::string_view kUnsafe = "/\\.:*?\"<>| '%#";
    for (char& character : name) {
        if (kUnsafe.find(character) != std::string_view::npos) character = '_';
    }
    shorten(name);
    return name.empty() ? "_" : name;
}

std::string without_capitals(std::string name) {
    for (char& character : name) {
        if (character >= 'A' && character <= 'Z') character = static_cast<char>(character + 32);
    }
    return name;
}

}  // namespace

std::vector<std::string> dataset_names(std::span<const std::string> photo_names,
                                       const std::vector<bool>& removed) {
    std::vector<std::string> names;
    names.reserve(photo_names.size());
    std::set<std::string> taken;
    std::map<std::string, std::string> left;  // by photographs that were taken out
    for (std::size_t i = 0; i < photo_names.size(); ++i) {
        const std::string first = flattened(photo_names[i]);
        std::string name = first;
        if (const auto before = left.extract(photo_names[i])) {
            name = before.mapped();
        } else {
            for (std::size_t k = 2; !taken.insert(without_capitals(name)).second; ++k)
                name = first + "_" + std::to_string(k);
        }
        if (removed[i]) left.insert_or_assign(photo_names[i], name);
        names.push_back(std::move(name));
    }
    return names;
}

std::string mask_name(const std::string& picture_name) {
    return picture_name.substr(0, picture_name.rfind('.')) + ".png";
}

}  // namespace psfm
