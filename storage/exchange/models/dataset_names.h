// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <vector>

namespace psfm {

/// Names of pictures without extension, one for each photograph, that every trainer and file system
/// takes: without folders, since some look for the last part of a name only; without dots, since
/// some cut names at the first; without blanks and what Windows refuses; all different, also where
/// capitals do not count. A name stays what it is when photographs are added at the end.
/// @param photo_names  relative paths, in the order of arrival
std::vector<std::string> dataset_names(std::span<const std::string> photo_names);

/// The mask of a picture: of a.jpg and a.png a.png, in a folder of masks, as Brush, LichtFeld
/// Studio and others look for it. @param picture_name  with its extension
std::string mask_name(const std::string& picture_name);

}  // namespace psfm
