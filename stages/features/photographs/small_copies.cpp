// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/small_copies.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <utility>

#include "stages/features/photographs/photo_container.h"
#include "stages/features/photographs/picture_signature.h"
#include "stages/features/photographs/read_exif.h"
#include "stages/features/photographs/read_file_bytes.h"
#include "stages/features/photographs/read_photo_options.h"
#include "stages/features/photographs/reduced_copy.h"
#include "stages/features/photographs/unread_files.h"

namespace psfm {
namespace {

/// The file name without folder and extension, in lower case.
std::string stem_of(const std::string& name) {
    const std::size_t slash = name.rfind('/');
    std::string stem = slash == name.npos ? name : name.substr(slash + 1);
    stem.resize(stem.size() - extension_of(stem).size());
    std::ranges::transform(stem, stem.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return stem;
}

struct Header {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::uint8_t orientation = 1;
    std::vector<std::uint8_t> signature = {};

    Glance glance() const { return {width, height, orientation, signature}; }
};

/// Size and orientation, from the beginning of the file; nothing where that does not tell.
std::optional<Header> read_header(const PhotoFile& photo) {
    // Guard: the largest EXIF data are 64 KiB.
    constexpr std::size_t kEnough = std::size_t{256} << 10U;
    std::ifstream stream(photo.path, std::ios::binary);
    std::vector<std::uint8_t> bytes(kEnough);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(kEnough));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
    const auto format = identify_format(bytes);
    if (!format) return std::nullopt;
    const PhotoContainer container = parse_container(*format, bytes);
    if (!container.size || container.size->width == 0 || container.size->height == 0)
        return std::nullopt;
    const auto width = static_cast<double>(container.size->width);
    const auto height = static_cast<double>(container.size->height);
    if (width * height > ReadPhotoOptions{}.max_megapixels * 1e6) return std::nullopt;
    Header header;
    header.width = static_cast<std::uint32_t>(container.size->width);
    header.height = static_cast<std::uint32_t>(container.size->height);
    header.orientation = read_exif(container.exif).orientation;
    return header;
}

/// What it shows, without keeping the file; empty when it cannot be read.
std::vector<std::uint8_t> read_signature(const PhotoFile& photo, const Header& header) {
    const auto bytes =
        read_file_bytes(photo, std::uint64_t{ReadPhotoOptions{}.max_file_mib} << 20U);
    if (!bytes.ok()) return {};  // Expected: taking the photograph in says so
    // Mathematics: an eighth leaves 4 pixels a field.
    constexpr std::uint32_t kEnoughReduced = 8 * 4 * kSignatureSide;
    const bool is_large = std::min(header.width, header.height) >= kEnoughReduced;
    try {
        const cv::Mat grey = cv::imdecode(
            *bytes, (is_large ? cv::IMREAD_REDUCED_GRAYSCALE_8 : cv::IMREAD_GRAYSCALE) |
                        cv::IMREAD_IGNORE_ORIENTATION);
        if (!grey.empty()) return picture_signature(grey, header.orientation);
    } catch (const cv::Exception&) {
        return {};
    }
    return {};
}

/// What is known of the photographs, read when it is asked for.
class Glances {
  public:
    Glances(const std::vector<PhotoFile>& photos, const SmallCopyOptions& options)
        : photos_(photos),
          options_(options),
          headers_(photos.size()),
          signed_(photos.size(), false) {}

    bool is_copy(std::size_t small, std::size_t large) {
        if (!may_be_copy(header(small).glance(), header(large).glance(), options_)) return false;
        return is_reduced_copy(with_signature(small).glance(), with_signature(large).glance(),
                               options_);
    }

  private:
    const Header& header(std::size_t i) {
        if (!headers_[i]) headers_[i] = read_header(photos_[i]).value_or(Header{});
        return *headers_[i];
    }
    const Header& with_signature(std::size_t i) {
        if (!signed_[i]) headers_[i]->signature = read_signature(photos_[i], *headers_[i]);
        signed_[i] = true;
        return *headers_[i];
    }

    const std::vector<PhotoFile>& photos_;
    const SmallCopyOptions& options_;
    std::vector<std::optional<Header>> headers_;  // of width 0: not known
    std::vector<bool> signed_;
};

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Whether what follows the common beginning is an addition to it: of "img_1" in "img_1-150x150" it
/// is, in "img_10" it is not.
bool is_addition(const std::string& shorter, const std::string& longer) {
    /// Guard: shorter ones begin too many other names, whose pixels would be compared in vain.
    constexpr std::size_t kLeastLength = 3;
    if (shorter.size() == longer.size()) return true;
    return shorter.size() >= kLeastLength &&
           !(is_digit(shorter.back()) && is_digit(longer[shorter.size()]));
}

/// Pairs of photographs whose names say that one may be a copy of the other.
std::vector<std::pair<std::size_t, std::size_t>> similar_names(
    const std::vector<PhotoFile>& photos) {
    std::multimap<std::string, std::size_t> forward;
    std::multimap<std::string, std::size_t> backward;
    for (std::size_t i = 0; i < photos.size(); ++i) {
        const std::string stem = stem_of(photos[i].name);
        forward.emplace(stem, i);
        backward.emplace(std::string(stem.rbegin(), stem.rend()), i);
    }
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    const auto collect = [&](const std::multimap<std::string, std::size_t>& stems) {
        for (auto at = stems.begin(); at != stems.end(); ++at) {
            for (auto next = std::next(at); next != stems.end(); ++next) {
                if (!next->first.starts_with(at->first)) break;
                if (is_addition(at->first, next->first))
                    pairs.emplace_back(at->second, next->second);
            }
        }
    };
    collect(forward);
    collect(backward);
    return pairs;
}

}  // namespace

void put_small_copies_last(std::vector<PhotoFile>& photos, const SmallCopyOptions& options) {
    Glances glances(photos, options);
    std::vector<bool> is_copy(photos.size(), false);
    for (const auto& [a, b] : similar_names(photos)) {
        if (glances.is_copy(a, b)) is_copy[a] = true;
        if (glances.is_copy(b, a)) is_copy[b] = true;
    }
    std::vector<PhotoFile> in_order;
    in_order.reserve(photos.size());
    for (const bool last : {false, true}) {
        for (std::size_t i = 0; i < photos.size(); ++i) {
            if (is_copy[i] == last) in_order.push_back(photos[i]);
        }
    }
    photos = std::move(in_order);
}

}  // namespace psfm
