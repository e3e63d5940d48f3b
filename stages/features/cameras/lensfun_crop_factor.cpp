// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/features/cameras/lensfun_crop_factor.h"

#include <lensfun/lensfun.h>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

#include <map>
#include <string>
#include <utility>

namespace psfm {
namespace {

/// (make, model), normalised -> crop factor.
using CropFactors = std::map<std::pair<std::string, std::string>, double>;

std::string normalized(std::string_view text) {
    std::string result;
    for (const char c : text) {
        const bool is_blank = c == ' ' || c == '\t';
        if (is_blank && (result.empty() || result.back() == ' ')) continue;
        result += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : (is_blank ? ' ' : c);
    }
    while (!result.empty() && result.back() == ' ') result.pop_back();
    return result;
}

CropFactors load_crop_factors() {
    CropFactors result;
#ifdef __SANITIZE_ADDRESS__
    // Lensfun 0.3.3 loses a path of 128 bytes in Load(); once a process.
    const __lsan::ScopedDisabler known_leak;
#endif
    try {
        lfDatabase database;
        if (database.Load() != LF_NO_ERROR) return {};
        const lfCamera* const* cameras = database.GetCameras();
        // A model with a variant (another aspect ratio of the same sensor, say) gives way to the
        // plain one.
        for (const bool take_variants : {false, true}) {
            for (const lfCamera* const* camera = cameras; camera != nullptr && *camera != nullptr;
                 ++camera) {
                const bool is_variant = (*camera)->Variant != nullptr;
                if (is_variant != take_variants) continue;
                if ((*camera)->Maker == nullptr || (*camera)->Model == nullptr) continue;
                const double crop = static_cast<double>((*camera)->CropFactor);
                // Guard: larger than medium format or smaller than a phone's sensor: not set.
                constexpr double kLeastCrop = 0.3;
                constexpr double kMostCrop = 20.0;
                if (!(crop > kLeastCrop && crop < kMostCrop)) continue;
                result.emplace(
                    std::pair(normalized((*camera)->Maker), normalized((*camera)->Model)), crop);
            }
        }
    } catch (...) {  // without a database there is no crop factor, that is all
        return {};
    }
    return result;
}

}  // namespace

std::optional<double> lensfun_crop_factor(std::string_view make, std::string_view model) {
    static const CropFactors crop_factors = load_crop_factors();
    const auto found = crop_factors.find({normalized(make), normalized(model)});
    if (found == crop_factors.end()) return std::nullopt;
    return found->second;
}

}  // namespace psfm
