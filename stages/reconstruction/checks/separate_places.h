// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "graph/reconstruction.h"
#include "graph/two_view_geometry.h"
#include "stages/reconstruction/model/place_options.h"

namespace psfm {

/// The places that a folded model shows (ours). A fold by a shift contradicts no rotation, and no
/// point either; but images of two streets then stand side by side, and share nothing. Every pair
/// side by side speaks for one place or for two, every other edge a little for one; the parts are
/// those between which more speaks for two (contract_signed_graph), where at least
/// min_contradictions pairs share nothing at all.
/// @param pairs  edges of the view graph, in any order; those with an image that is not registered
/// do not count
/// @return images of each place, ascending, the largest first, as far as they are contradicted by
/// another one: there may be images in none. Empty: no fold to be seen
/// Deterministic on any number of threads. Thread-safe.
std::vector<std::vector<ImageId>> separate_places(const Reconstruction& model,
                                                  std::span<const VerifiedPairPtr> pairs,
                                                  const PlaceOptions& options);

/// Whether newly registered images give reason to ask separate_places(): one stands beside an image
/// that shares hardly anything of what it sees. Their own pairs alone are looked at, so that a
/// model whose images were all asked when they were added need not be asked again. Thread-safe.
/// @param seen  points, among them all that the images observe
bool may_show_another_place(const Reconstruction& model, const ScenePoints& seen,
                            std::span<const ImageId> images, const PlaceOptions& options);

}  // namespace psfm
