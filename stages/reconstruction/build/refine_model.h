// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "graph/result.h"
#include "stages/reconstruction/build/recycle_models.h"
#include "stages/reconstruction/model/plan_solve.h"
#include "stages/reconstruction/model/solve_context.h"
#include "stages/reconstruction/model/solve_options.h"
#include "stages/reconstruction/model/working_model.h"

namespace psfm {

/// Adjusts all of a model: completes and joins tracks, adjusts, filters, and again until little
/// changes; takes out images that are left with too few observations.
/// @return bundle adjustments done, here and below
/// @errors kDegenerate, kCancelled
Result<std::uint32_t> refine_model(WorkingModel& model, const RefinementOptions& refinement,
                                   const RefineContext& context);

/// The same after much of a model has changed: to convergence (`growth`) or, roughly, in the few
/// steps of `large_growth`.
/// @errors kDegenerate, kCancelled
Result<std::uint32_t> refine_changed_model(WorkingModel& model, SolveEffort effort,
                                           const RefineContext& context);

/// The same, roughly (`large_growth`), of some images, of all who share points with them, and so on
/// until there are so many; the rest of the model holds the gauge. All of it is adjusted when that
/// would be most of it (`max_region`).
/// @param images  ascending; those that are not registered do not count
/// @errors kDegenerate, kCancelled
Result<std::uint32_t> refine_around(WorkingModel& model, std::vector<std::uint32_t> images,
                                    std::size_t at_least, const RefineContext& context);

/// Adjusts a model that others were joined to: all of it (refine_changed_model) or, where the
/// plan has kJoint, the joined images and the first model around the joint, whose far
/// end holds the gauge: a part that was moved by a similarity is not held by anything else, and
/// finds its place as a whole.
/// @errors kDegenerate, kCancelled
Result<std::uint32_t> refine_joined(WorkingModel& model, const Recycling& joined,
                                    const SolvePlan& plan, const RefineContext& context);

/// Makes one of the tracks that small models and the one that they were joined to have apart, and
/// adjusts the joined images with their neighbours (refine_locally).
/// @param joined  images of the models that were joined to the first, ascending
/// @errors kDegenerate, kCancelled
Result<std::uint32_t> refine_joined_locally(WorkingModel& model,
                                            std::span<const std::uint32_t> joined,
                                            const RefineContext& context);

/// Adjusts a model that has grown by so many images since the last time: all of it, as in the
/// paper, or, where the plan has kJoint, the images that came last, with their neighbours.
/// @errors kDegenerate, kCancelled
Result<std::uint32_t> refine_grown(WorkingModel& model, std::uint32_t grown, const SolvePlan& plan,
                                   const RefineContext& context);

/// Adjusts images and their surroundings: creates and continues their points, adjusts them with the
/// neighbours that share most points with them, filters, and once more where much was filtered.
/// @param images  ascending
/// @errors kDegenerate (poses and points are as the last adjustment that found a solution left
/// them), kCancelled
Result<std::uint32_t> refine_locally(WorkingModel& model, std::span<const std::uint32_t> images,
                                     const RefineContext& context);

/// Registered images with fewer observations than the options ask for are taken out of the model.
/// @return how many
std::uint32_t remove_weak_images(WorkingModel& model, const SolveOptions& options);

}  // namespace psfm
