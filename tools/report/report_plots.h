// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "tools/report/report_facts.h"

namespace psfm {

// The report's plots, each an <svg> element.

/// How densely a part is covered by points, from above, and where its cameras stand.
std::string coverage_plot(const PartFacts& part, const ReportFacts& facts);

/// The verified pairs of a part's images, over where these stand. @param most  edges drawn: those
/// with most matches, and of the others each that contradicts
std::string view_graph_plot(const PartFacts& part, const ReportFacts& facts, std::size_t most);

/// Matches of all images with all, in order of arrival, in cells of several images each where there
/// are many.
std::string match_matrix_plot(const ReportFacts& facts);

/// Where in the photograph features lie off their points: arrows of the mean residual, exaggerated.
std::string residual_plot(const CameraFacts& camera);

std::string error_histogram_plot(const ReportFacts& facts);
std::string track_length_plot(const ReportFacts& facts);
/// Images, placed ones and parts over the versions that are kept.
std::string history_plot(const ReportFacts& facts);

}  // namespace psfm
