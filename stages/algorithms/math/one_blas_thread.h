// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace psfm {

/// Keeps OpenBLAS on the thread that calls it, in the whole program and from then on: it would use
/// all cores from each of TBB's threads, and sum in an order that depends on their number. To be
/// called before its first use; again costs nothing. Thread-safe.
void keep_blas_on_one_thread();

}  // namespace psfm
