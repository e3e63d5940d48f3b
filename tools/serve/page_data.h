// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/report/image_facts.h"
#include "tools/serve/hints.h"
#include "tools/serve/shown_scene.h"

namespace psfm {

// What the pages are given of a session (docs/serve.md). None of it holds a position on the earth.

struct PageSession {
    std::string name;
    const SessionFacts* facts = nullptr;
    const std::vector<EdgeFact>* edges = nullptr;
    std::vector<Hint> hints;
    std::map<CameraId, Camera> cameras;  ///< as accepted
    bool in_metres = false;              ///< parts stand where positions put them
    std::vector<std::string> users;
    /// Who asks, when there are users.
    std::string me, role;
};

/// `Session` of tools/viewer/src/source.ts, as JSON text.
std::string session_json(const PageSession& session);

/// Which images see the point in each slot of a shown scene; see readTracks of source.ts.
std::string tracks_bytes(const Scene& scene, const ShownScene& shown);

/// Colours of features, an image's read once and the last few images' kept.
class FeatureColours {
  public:
    explicit FeatureColours(const SessionReader& session) : session_(&session) {}
    /// Grey when it cannot be read.
    Colour operator()(const Observation& feature);

  private:
    static constexpr std::size_t kImages = 64;  // Guard: of some 24 KB each
    const SessionReader* session_;
    std::map<ImageId, std::vector<Colour>> known_;
    std::vector<ImageId> order_;  // the oldest first
};

}  // namespace psfm
