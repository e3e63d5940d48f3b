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
/// capitals do not count. A name stays what it is when photographs are added at the end, or taken
/// out; that of one which was taken out goes to the next that is called as it was.
/// @param photo_names  relative paths, in the order of arrival
/// @param removed  beside each: whether it was taken out again
std::vector<std::string> dataset_names(std::span<const std::string> photo_names,
                                       const std::vector<bool>& removed);

/// The mask of a picture: of a.jpg and a.png a.png, in a folder of masks, as Brush, LichtFeld
/// Studio and others look for it. @param picture_name  with its extension
std::string mask_name(const std::string& picture_name);

}  // namespace psfm
