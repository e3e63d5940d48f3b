// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/commands/session/photo_order.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <random>
#include <string_view>
#include <utility>

#include "storage/exchange/files/image_name.h"

namespace psfm {
namespace {

/// The next line, cut off when it is too long for a name: what is no order file may have no end.
bool next_line(std::istream& stream, std::string& line) {
    // Guard: a path of Linux and CR LF; there may be no end.
    constexpr std::size_t kLongestLine = 4096 + 2;
    line.clear();
    for (char c = 0; line.size() < kLongestLine && stream.get(c);) {
        if (c == '\n') return true;
        line.push_back(c);
    }
    return !line.empty();
}

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

/// A mark of UTF-16, as Windows' editors write for "Unicode".
bool is_utf16(std::string_view line) {
    return line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF");
}

}  // namespace

std::vector<std::string> shuffled_names(std::vector<std::string> names, std::uint64_t seed) {
    std::ranges::sort(names);
    std::mt19937_64 random(seed);
    for (std::size_t i = names.size(); i-- > 1;) std::swap(names[i], names[random() % (i + 1)]);
    return names;
}

Result<std::vector<std::string>> read_order_file(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file)) {
        return Error{ErrorCode::kNotFound, "cannot read the order file " + file.string() +
                                               "; it holds one image name a line"};
    }
    std::vector<std::string> names;
    std::set<std::string> seen;
    std::string line;
    for (std::size_t number = 1; next_line(stream, line); ++number) {
        if (number == 1 && is_utf16(line)) {
            return Error{ErrorCode::kInvalidArgument,
                         "the order file " + file.string() + " is UTF-16; save it as UTF-8"};
        }
        if (number == 1 && line.starts_with(kUtf8Mark)) line.erase(0, kUtf8Mark.size());
        if (!line.empty() && line.back() == '\r') line.pop_back();
        if (line.empty()) continue;
        std::string where = file.string();
        where.append(" line ").append(std::to_string(number));
        if (const auto problem = problem_of_name(line)) {
            return Error{ErrorCode::kInvalidArgument,
                         where + ": the name " + *problem +
                             "; write names as they are within the photograph folder"};
        }
        if (!seen.insert(line).second) {
            return Error{ErrorCode::kInvalidArgument,
                         where + ": " + line + " is named a second time; remove one of the lines"};
        }
        names.push_back(line);
    }
    if (names.empty())
        return Error{ErrorCode::kInvalidArgument,
                     "the order file " + file.string() + " names no image"};
    return names;
}

Result<std::vector<PhotoFile>> photos_in_order(std::vector<PhotoFile> photos,
                                               const std::vector<std::string>& order,
                                               const std::set<std::string>& known,
                                               const std::filesystem::path& input) {
    if (order.empty()) return photos;
    std::map<std::string, PhotoFile> by_name;
    for (PhotoFile& photo : photos) by_name.emplace(photo.name, std::move(photo));
    std::vector<PhotoFile> ordered;
    for (const std::string& name : order) {
        const auto found = by_name.find(name);
        if (found != by_name.end()) {
            ordered.push_back(std::move(found->second));
        } else if (!known.contains(name)) {
            return Error{ErrorCode::kNotFound,
                         "the order names " + name + ", which is not in " + input.string() +
                             "; correct the order file, or copy the photograph there"};
        }
    }
    return ordered;
}

}  // namespace psfm
