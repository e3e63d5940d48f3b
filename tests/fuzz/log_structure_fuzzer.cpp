// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// RocksDB's logs, as they are looked through before RocksDB may open them.
#include "storage/database/log_structure.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)is_damaged_inside(fuzz::as_text({data, size}));
    return 0;
}

}  // namespace psfm
