// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace psfm::fuzz {

/// The folder that seeds are written to, a folder in it for each target.
class SeedFolder {
  public:
    explicit SeedFolder(std::filesystem::path path) : path_(std::move(path)) {}
    void write(const char* target, const std::string& name, std::string_view bytes) const;
    /// For what can only be written to a file. @return a path in the target's folder
    std::filesystem::path file(const char* target, const std::string& name) const;

  private:
    std::filesystem::path path_;
};

std::string file_contents(const std::filesystem::path& path);

void write_photo_seeds(const SeedFolder& seeds);
void write_exchange_seeds(const SeedFolder& seeds);
void write_record_seeds(const SeedFolder& seeds);

}  // namespace psfm::fuzz
