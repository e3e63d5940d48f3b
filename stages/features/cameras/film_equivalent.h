// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace psfm {

/// How a camera worked out its FocalLengthIn35mmFilm. The same at 3:2, 4 % apart at 4:3.
enum class FilmEquivalent {
    kDiagonal,  ///< equal diagonals: CIPA DCG-001, which camera makers keep to
    kLongSide,  ///< the longer side against 36 mm, as some programs and renderers have it
};

}  // namespace psfm
