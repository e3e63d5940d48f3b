// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tests/stages/features/photo_fixture.h"

#include <stdlib.h>

#include <exiv2/exiv2.hpp>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace psfm::testing {

TemporaryFolder::TemporaryFolder() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "psfm-features-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

PhotoFile TemporaryFolder::write(std::string_view name, std::span<const std::uint8_t> bytes) const {
    const std::filesystem::path path = path_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    if (!file) throw std::runtime_error("cannot write " + path.string());
    return {path, std::string(name)};
}

PhotoFile TemporaryFolder::write(std::string_view name, std::string_view text) const {
    return write(name, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

cv::Mat textured_image(int width, int height, std::uint64_t seed) {
    cv::RNG random(seed);
    cv::Mat noise(height, width, CV_8UC3);
    random.fill(noise, cv::RNG::UNIFORM, 0, 256);
    cv::Mat result;
    cv::GaussianBlur(noise, result, {}, 2.0);
    cv::normalize(result, result, 0, 255, cv::NORM_MINMAX);
    return result;
}

Bytes encode(const cv::Mat& image, const std::string& extension) {
    Bytes bytes;
    if (!cv::imencode(extension, image, bytes))
        throw std::runtime_error("cannot encode " + extension);
    return bytes;
}

Bytes with_exif(const Bytes& bytes, const Exiv2::ExifData& exif) {
    const auto image = Exiv2::ImageFactory::open(bytes.data(), static_cast<long>(bytes.size()));
    image->readMetadata();
    image->setExifData(exif);
    image->writeMetadata();
    Exiv2::BasicIo& io = image->io();
    io.open();
    const Exiv2::DataBuf buffer = io.read(static_cast<long>(io.size()));
    return {buffer.pData_, buffer.pData_ + buffer.size_};
}

}  // namespace psfm::testing
