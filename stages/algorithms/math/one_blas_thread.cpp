// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "stages/algorithms/math/one_blas_thread.h"

#include <cblas.h>

#include <mutex>

namespace psfm {

void keep_blas_on_one_thread() {
    static std::once_flag done;
    std::call_once(done, [] { openblas_set_num_threads(1); });
}

}  // namespace psfm
