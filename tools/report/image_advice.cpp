// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/report/image_advice.h"

namespace psfm {

const char* advice_for(WaitReason reason) {
    switch (reason) {
        case WaitReason::kNone:
            return "";
        case WaitReason::kTooFewMatches:
            return "add photographs of the same place that share two thirds of their view with "
                   "this one";
        case WaitReason::kClusterTooSmall:
            return "add photographs of what it shows: too few belong together for a model";
        case WaitReason::kNoSeed:
            return "add photographs taken a step to the side: the camera has hardly moved between "
                   "these";
        case WaitReason::kRegistrationFailed:
            return "add one or two photographs from between this one and the model";
        case WaitReason::kNoParallax:
            return "walk between photographs: no depth follows from turning on the spot";
        case WaitReason::kStandsStill:
            return "crop away what stands still in the photographs, or take the object before a "
                   "plain background";
        case WaitReason::kTooFewFeatures:
            return "take a sharp, well-lit photograph of something with texture instead";
        case WaitReason::kLookAlikes:
            return "add photographs from between this one and the model, or of what stands beside "
                   "the things that look alike";
        case WaitReason::kSolving:
            return "wait for the next version, which takes account of it";
    }
    return "";
}

RejectionWords split_rejection(const std::string& name, const std::string& stored_reason) {
    std::string_view reason = stored_reason;
    for (const char* end : {": ", " "}) {
        if (reason == stored_reason && reason.starts_with(name + end))
            reason.remove_prefix(name.size() + std::string_view(end).size());
    }
    const std::size_t cut = reason.rfind("; ");
    if (cut == std::string_view::npos) return {std::string(reason), {}};
    return {std::string(reason.substr(0, cut)), std::string(reason.substr(cut + 2))};
}

}  // namespace psfm
