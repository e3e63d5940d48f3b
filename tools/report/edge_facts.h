// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "graph/ids.h"
#include "graph/result.h"
#include "graph/scene.h"
#include "scheduler/session/session_config.h"
#include "stages/clustering/select_edges.h"
#include "storage/session/session_store.h"

namespace psfm {

/// What became of a verified pair.
enum class EdgeState : std::uint8_t {
    kHolds = 0,        ///< both images are placed in one part, as the pair says
    kOpen = 1,         ///< an edge of the view graph that no model says anything of
    kImplausible = 2,  ///< no edge: weak beside what its images reach elsewhere
    kApart = 3,        ///< no edge: its images are of different places
    kContradicts = 4,  ///< an edge, but the model has its images turned otherwise
};
const char* edge_state_name(EdgeState state);

struct EdgeFact {
    ImagePair pair;
    std::uint32_t matches = 0;
    EdgeState state = EdgeState::kOpen;
    float angle_deg = 0.F;  ///< between the pair's relative rotation and the model's; 0: not known
};

/// The verified pairs of a session, which are read once.
class EdgeBook {
  public:
    explicit EdgeBook(const StageOptions& options)
        : options_(options.edges), max_contradiction_deg_(options.solve.max_contradiction_deg) {}

    /// Every verified pair, ascending.
    /// @param scene  models without points will do
    /// @errors those of the store
    Result<std::vector<EdgeFact>> read(const SessionReader& session, const Scene& scene);

  private:
    struct KnownPair {
        ImagePair pair;
        std::uint32_t matches = 0;
        Eigen::Quaterniond cam2_from_cam1;
    };
    EdgeSelectionOptions options_;
    double max_contradiction_deg_;
    EdgeSelection selection_;
    ViewGraph graph_;
    std::vector<KnownPair> pairs_;
    std::uint32_t images_ = 0;  // whose pairs are there
};

/// The same once, with the options that the session was made with.
Result<std::vector<EdgeFact>> read_edges(const SessionReader& session, const Scene& scene);

/// The options that a session was made with; the default ones where its settings cannot be read.
StageOptions options_of(const SessionReader& session);

}  // namespace psfm
