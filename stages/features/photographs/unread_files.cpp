// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/photographs/unread_files.h"

#include <algorithm>
#include <array>

namespace psfm {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::array kRawExtensions{".3fr"sv, ".arw"sv, ".cr2"sv, ".cr3"sv, ".crw"sv, ".dcr"sv,
                                    ".dng"sv, ".erf"sv, ".fff"sv, ".gpr"sv, ".iiq"sv, ".k25"sv,
                                    ".kdc"sv, ".mef"sv, ".mos"sv, ".mrw"sv, ".nef"sv, ".nrw"sv,
                                    ".orf"sv, ".pef"sv, ".raf"sv, ".raw"sv, ".rw2"sv, ".rwl"sv,
                                    ".sr2"sv, ".srf"sv, ".srw"sv, ".x3f"sv};
constexpr std::array kVideoExtensions{
    ".3gp"sv, ".360"sv, ".avi"sv,  ".braw"sv, ".insv"sv, ".lrv"sv, ".m2ts"sv, ".m4v"sv,  ".mkv"sv,
    ".mov"sv, ".mp4"sv, ".mpeg"sv, ".mpg"sv,  ".mts"sv,  ".mxf"sv, ".ogv"sv,  ".webm"sv, ".wmv"sv};
constexpr std::array kOtherExtensions{".dds"sv, ".exr"sv, ".gif"sv,  ".hdr"sv, ".insp"sv,
                                      ".j2c"sv, ".j2k"sv, ".jpc"sv,  ".jps"sv, ".jpx"sv,
                                      ".jxl"sv, ".jxr"sv, ".livp"sv, ".pam"sv, ".pbm"sv,
                                      ".pfm"sv, ".psb"sv, ".psd"sv,  ".tga"sv, ".xcf"sv};

struct KindText {
    const char* one;
    const char* many;
    const char* remedy;
};

KindText text_of(UnreadKind kind) {
    switch (kind) {
        case UnreadKind::kRaw:
            return {"raw photograph", "raw photographs", "develop them, and export JPEG or TIFF"};
        case UnreadKind::kVideo:
            return {"video", "videos",
                    "take frames out of them, e.g. ffmpeg -i FILE -vf fps=2 frames/%05d.jpg"};
        case UnreadKind::kOther:
            break;
    }
    return {"picture of a format that is not read", "pictures of formats that are not read",
            "export them as JPEG or PNG"};
}

std::size_t count_of(const std::map<std::string, std::size_t>& extensions) {
    std::size_t count = 0;
    for (const auto& [extension, files] : extensions) count += files;
    return count;
}

/// ".dng, 3 .nef"
std::string list_of(const std::map<std::string, std::size_t>& extensions) {
    std::string list;
    for (const auto& [extension, files] : extensions) {
        if (!list.empty()) list += ", ";
        if (files > 1) list += std::to_string(files) + ' ';
        list += extension;
    }
    return list;
}

}  // namespace

std::string extension_of(std::string_view name) {
    const std::size_t slash = name.rfind('/');
    const std::string_view base = slash == name.npos ? name : name.substr(slash + 1);
    const std::size_t dot = base.rfind('.');
    if (dot == base.npos || dot == 0) return {};
    std::string extension(base.substr(dot));
    std::ranges::transform(extension, extension.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return extension;
}

std::optional<UnreadKind> unread_kind(std::string_view name) {
    const std::string extension = extension_of(name);
    const auto is_one_of = [&](const auto& known) {
        return std::ranges::find(known, extension) != known.end();
    };
    if (is_one_of(kRawExtensions)) return UnreadKind::kRaw;
    if (is_one_of(kVideoExtensions)) return UnreadKind::kVideo;
    if (is_one_of(kOtherExtensions)) return UnreadKind::kOther;
    return std::nullopt;
}

std::vector<std::string> describe(const UnreadFiles& files) {
    std::vector<std::string> lines;
    for (const auto& [kind, extensions] : files) {
        const std::size_t count = count_of(extensions);
        const KindText text = text_of(kind);
        std::string line = "not taken: " + std::to_string(count) + ' ';
        line += count == 1 ? text.one : text.many;
        lines.push_back(line + " (" + list_of(extensions) + "); " + text.remedy);
    }
    return lines;
}

std::string describe_briefly(const UnreadFiles& files) {
    std::map<std::string, std::size_t> all;
    for (const auto& [kind, extensions] : files) all.insert(extensions.begin(), extensions.end());
    const std::size_t count = count_of(all);
    if (count == 0) return {};
    return std::to_string(count) + (count == 1 ? " file (" : " files (") + list_of(all) + ')';
}

}  // namespace psfm
