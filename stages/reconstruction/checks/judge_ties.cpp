// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/reconstruction/checks/judge_ties.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <ranges>
#include <utility>

#include "stages/algorithms/math/most_common.h"
#include "stages/reconstruction/checks/few_zooms.h"

namespace psfm {
namespace {

/// Kinds that a better lens explains whole: none of theirs deviates.
void excuse(Kinds& kinds, const Kinds& with_better_lens) {
    for (const auto& kind : with_better_lens) {
        if (!any_deviates(kind.second)) kinds[kind.first] = kind.second;
    }
}

/// Where some of a kind deviate, all are sorted by focal length, and parted where these leave a
/// gap. Parts in which none deviates are one: what wanders and gains nothing stays together. Where
/// there is no gap, each stays by itself.
void part_by_focal(const std::vector<ReleasedCamera>& kind, double max_step,
                   std::map<CameraId, std::size_t>& labels, std::size_t& next) {
    std::vector<const ReleasedCamera*> sorted;
    sorted.reserve(kind.size());
    for (const ReleasedCamera& camera : kind) sorted.push_back(&camera);
    std::ranges::sort(
        sorted, {}, [](const ReleasedCamera* c) { return std::pair(c->own_focal_px, c->camera); });
    const auto follows = [&](const ReleasedCamera* before, const ReleasedCamera* camera) {
        return std::log(camera->own_focal_px / before->own_focal_px) < max_step;
    };
    for (auto first = sorted.begin(); first != sorted.end();) {
        auto last = std::next(first);
        while (last != sorted.end() && follows(*std::prev(last), *last)) ++last;
        const bool is_all = first == sorted.begin() && last == sorted.end();
        if (std::any_of(first, last, [](const ReleasedCamera* c) { return c->deviates; })) {
            ++next;
            for (auto camera = first; camera != last; ++camera)
                labels[(*camera)->camera] = is_all ? ++next : next;
        }
        first = last;
    }
}

/// Whether all of a kind are tied to one another.
bool tied_in(const CameraTies& ties, const std::vector<ReleasedCamera>& kind) {
    const auto labels = labels_of(ties);
    return std::ranges::all_of(kind, [&](const ReleasedCamera& camera) {
        return labels.at(camera.camera) == labels.at(kind.front().camera);
    });
}

}  // namespace

TieVerdict judge_ties(const std::shared_ptr<const Reconstruction>& model,
                      const ClusterProblem& problem, const CameraTies& ties,
                      const SolveOptions& options) {
    TieVerdict verdict{ties, model, {}};
    const CameraTies all = all_tied(problem);
    const TiedModel together = adjust_tied(model, problem, all, 1, options.ties);
    if (!together.model) return verdict;
    // What was tied differently is nearer to what each is by itself than what was bent together.
    const TiedModel apart = adjust_tied(ties == all ? together.model : model, problem,
                                        untied(problem), 1, options.ties);
    if (!apart.model) return verdict;
    auto kinds = compare_ties(together, apart, problem, options.ties);
    if (options.ties.second_coefficient &&
        std::ranges::any_of(kinds, [](const auto& kind) { return any_deviates(kind.second); })) {
        const TiedModel with = adjust_tied(together.model, problem, all, 2, options.ties);
        if (with.model) excuse(kinds, compare_ties(with, apart, problem, options.ties));
    }

    std::map<CameraId, std::size_t> labels = labels_of(all);
    std::size_t next = labels.size();
    bool any_leaves = false;
    for (const auto& [kind, cameras] : kinds) {
        verdict.released.insert(verdict.released.end(), cameras.begin(), cameras.end());
        if (!any_deviates(cameras)) continue;
        any_leaves = true;
        // A model that was bent for one camera tells no focal lengths: what they are is asked of
        // one that was solved without.
        if (tied_in(ties, cameras)) {
            for (const ReleasedCamera& camera : cameras) labels[camera.camera] = ++next;
            continue;
        }
        const auto zooms = find_zooms(cameras, apart, problem, labels, options.ties);
        for (const auto& [camera, zoom] : zooms) labels[camera] = next + 1 + zoom;
        next += zooms.size();  // there are no more of them than cameras
        if (zooms.empty()) part_by_focal(cameras, options.ties.max_step, labels, next);
        // What is not placed yet goes with most of them.
        const auto label_of = [&](const ReleasedCamera& camera) { return labels[camera.camera]; };
        const std::size_t most = most_common(cameras | std::views::transform(label_of)).first;
        for (const auto& [id, of_kind] : problem.alike) {
            const bool is_placed = std::ranges::any_of(
                cameras, [&](const ReleasedCamera& camera) { return camera.camera == id; });
            if (of_kind == kind && !is_placed) labels[id] = most;
        }
    }
    verdict.ties = any_leaves ? ties_of(labels, problem) : all;
    verdict.model = with_ties(any_leaves ? apart.model : together.model, problem, verdict.ties);
    return verdict;
}

}  // namespace psfm
