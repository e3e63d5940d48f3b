// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// Vocabulary files, as they are and with their checksum put right: without that nothing behind the
// checksum would ever be reached.
#include <xxhash.h>

#include <cstring>
#include <vector>

#include "stages/retrieval/vocabulary_file.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::InputFolder folder;
    constexpr std::size_t kChecksumOffset = 24;  // VOCABULARY_FORMAT.md
    constexpr std::size_t kHeaderBytes = 32;
    std::vector<std::uint8_t> bytes(data, data + size);
    (void)read_vocabulary(folder.write("vocabulary", bytes));
    if (size < kHeaderBytes) return 0;
    std::vector<std::uint8_t> hashed(bytes);
    hashed.erase(hashed.begin() + kChecksumOffset, hashed.begin() + kHeaderBytes);
    const std::uint64_t checksum = XXH64(hashed.data(), hashed.size(), 0);
    std::memcpy(bytes.data() + kChecksumOffset, &checksum, sizeof(checksum));
    const auto tree = read_vocabulary(folder.write("vocabulary", bytes));
    if (!tree.ok()) return 0;
    fuzz::require(tree->cells.rows() == tree->words.size(), "each cell has its words");
    fuzz::require((tree->word_count() + tree->cells.rows()) * 128 < size,
                  "a vocabulary is no larger than its file");
    return 0;
}

}  // namespace psfm
