// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Seeds of the fuzz targets: small and valid inputs, by the same encoders that psfm writes with.
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "tests/fuzz/seeds.h"

namespace psfm::fuzz {

void SeedFolder::write(const char* target, const std::string& name, std::string_view bytes) const {
    const std::filesystem::path path = file(target, name);
    std::ofstream stream(path, std::ios::binary);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!stream) throw std::runtime_error("cannot write " + path.string());
}

std::filesystem::path SeedFolder::file(const char* target, const std::string& name) const {
    std::filesystem::create_directories(path_ / target);
    return path_ / target / name;
}

std::string file_contents(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace psfm::fuzz

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fputs("usage: psfm_make_seeds FOLDER   (one folder a fuzz target is made in it)\n",
                   stderr);
        return 2;
    }
    try {
        const psfm::fuzz::SeedFolder seeds(argv[1]);
        psfm::fuzz::write_photo_seeds(seeds);
        psfm::fuzz::write_exchange_seeds(seeds);
        psfm::fuzz::write_record_seeds(seeds);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "no seeds: %s\n", error.what());
        return 1;
    }
    return 0;
}
