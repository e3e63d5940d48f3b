// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace psfm {

/// Film diagonal over sensor diagonal of a camera, from Lensfun's database as installed (and the
/// user's own additions). Make and model as EXIF has them, compared without regard to case and
/// repeated blanks. Where Lensfun knows several modes of one model, the plain one.
/// @return nothing for an unknown camera, or when the database is not installed
/// Thread-safe: the first call reads the database (about 0.1 s) into a table that lives as long as
/// the process and never changes, since Lensfun's own loader is neither quick nor thread-safe.
std::optional<double> lensfun_crop_factor(std::string_view make, std::string_view model);

}  // namespace psfm
