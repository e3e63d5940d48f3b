// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "storage/database/solution_chain.h"

#include <utility>

namespace psfm {
namespace {

constexpr const char* kImpossible = "is stored as changes to what cannot be";

Error damage(const ReadView& view, Family family, const SolutionKey& key, const char* problem) {
    return view.about(family, encode_key(key), {ErrorCode::kDamaged, problem});
}

/// The record under `key` and those that it changes, up to the one that is whole; empty when there
/// is no such record.
template <typename Part, typename Decode>
Result<std::vector<Part>> read_chain(const ReadView& view, Family family, RecordKind kind,
                                     const SolutionKey& key, const Decode& decode) {
    std::vector<Part> chain;
    for (SolutionKey at = key;;) {
        auto part = fetch<Part>(view, family, kind, encode_key(at), decode);
        if (!part.ok()) return part.error();
        if (!part->has_value()) {
            if (chain.empty()) return chain;
            return damage(view, family, at, "is missing; a later one is stored as changes to it");
        }
        const std::uint32_t since = (*part)->since;
        chain.push_back(**std::move(part));
        if (since == 0) return chain;
        if (since >= at.revision || chain.size() >= kLongestChain)
            return damage(view, family, at, kImpossible);
        at.revision = since;
    }
}

}  // namespace

Result<std::optional<Reconstruction>> read_poses(const ReadView& view, const SolutionKey& key) {
    auto chain =
        read_chain<SolutionPoses>(view, Family::kSolutions, RecordKind::kPoses, key, decode_poses);
    if (!chain.ok()) return chain.error();
    if (chain->empty()) return std::optional<Reconstruction>();
    Reconstruction model = std::move(chain->back().model);
    for (chain->pop_back(); !chain->empty(); chain->pop_back()) {
        const auto applied = apply(std::move(chain->back()), model);
        if (!applied.ok()) return view.about(Family::kSolutions, encode_key(key), applied.error());
    }
    return std::optional(std::move(model));
}

Result<std::optional<SolutionPoints>> read_points(const ReadView& view, const SolutionKey& key) {
    auto chain =
        read_chain<SolutionPoints>(view, Family::kPoints, RecordKind::kPoints, key, decode_points);
    if (!chain.ok()) return chain.error();
    if (chain->empty()) return std::optional<SolutionPoints>();
    SolutionPoints result = std::move(chain->back());
    for (chain->pop_back(); !chain->empty(); chain->pop_back()) {
        result.state_json = std::move(chain->back().state_json);
        const auto applied = apply(chain->back(), result.points);
        if (!applied.ok()) return view.about(Family::kPoints, encode_key(key), applied.error());
    }
    return std::optional(std::move(result));
}

Result<std::optional<std::uint32_t>> revision_before(const ReadView& view, const SolutionKey& key) {
    const auto poses = fetch<SolutionPoses>(view, Family::kSolutions, RecordKind::kPoses,
                                            encode_key(key), decode_poses);
    if (!poses.ok()) return poses.error();
    if (!poses->has_value()) return std::optional<std::uint32_t>();
    const std::uint32_t since = (*poses)->since;
    if (since >= key.revision) return damage(view, Family::kSolutions, key, kImpossible);
    return std::optional(since);
}

}  // namespace psfm
