// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
// What a session keeps as JSON: its settings, the summary of a version, the state of a solution.
#include "scheduler/session/encode_state.h"
#include "scheduler/session/session_config.h"
#include "tests/fuzz/fuzz_input.h"

namespace psfm {

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr auto kSame = "what is read and written is read as the same";
    const std::string text(fuzz::as_text({data, size}));
    if (const auto config = decode_config(text); config.ok()) {
        const std::string written = encode_config(*config);
        const auto again = decode_config(written);
        fuzz::require(again.ok() && encode_config(*again) == written, kSame);
    }
    if (const auto summary = decode_summary(text); summary.ok()) {
        const std::string written = encode_summary(*summary);
        const auto again = decode_summary(written);
        fuzz::require(again.ok() && encode_summary(*again) == written, kSame);
    }
    if (const auto state = decode_solve_state(text); state.ok()) {
        const std::string written = encode_solve_state(*state);
        const auto again = decode_solve_state(written);
        fuzz::require(again.ok() && encode_solve_state(*again) == written, kSame);
    }
    return 0;
}

}  // namespace psfm
