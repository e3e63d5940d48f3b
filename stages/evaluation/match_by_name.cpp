// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <string_view>

#include "stages/evaluation/named_pose.h"

namespace psfm {
namespace {

std::string_view last_part(std::string_view name) {
    const std::size_t slash = name.rfind('/');
    return slash == std::string_view::npos ? name : name.substr(slash + 1);
}

/// Last part of a name -> positions that have it.
using Positions = std::map<std::string_view, std::vector<std::size_t>>;

Positions by_last_part(std::span<const NamedPose> poses) {
    Positions positions;
    for (std::size_t i = 0; i < poses.size(); ++i) positions[last_part(poses[i].name)].push_back(i);
    return positions;
}

}  // namespace

std::vector<NameMatch> match_by_name(std::span<const NamedPose> reference,
                                     std::span<const NamedPose> model) {
    std::map<std::string_view, std::size_t> reference_of_name;
    for (std::size_t i = 0; i < reference.size(); ++i)
        reference_of_name.emplace(reference[i].name, i);

    std::vector<NameMatch> matches;
    std::vector<bool> reference_taken(reference.size(), false);
    std::vector<bool> model_taken(model.size(), false);
    const auto take = [&](std::size_t in_reference, std::size_t in_model) {
        matches.push_back({in_reference, in_model});
        reference_taken[in_reference] = true;
        model_taken[in_model] = true;
    };
    for (std::size_t i = 0; i < model.size(); ++i) {
        const auto found = reference_of_name.find(model[i].name);
        if (found != reference_of_name.end()) take(found->second, i);
    }
    const Positions reference_parts = by_last_part(reference);
    for (const auto& [part, positions] : by_last_part(model)) {
        const auto found = reference_parts.find(part);
        if (found == reference_parts.end() || positions.size() != 1 || found->second.size() != 1)
            continue;
        if (!model_taken[positions[0]] && !reference_taken[found->second[0]]) {
            take(found->second[0], positions[0]);
        }
    }
    std::ranges::sort(matches, {}, [&](const NameMatch& match) -> const std::string& {
        return reference[match.reference].name;
    });
    return matches;
}

}  // namespace psfm
