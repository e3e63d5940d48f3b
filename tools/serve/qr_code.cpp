// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tools/serve/qr_code.h"

#include <qrencode.h>

#include <memory>

namespace psfm {

std::string qr_code(const std::string& text) {
    const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(
        QRcode_encodeString8bit(text.c_str(), 0, QR_ECLEVEL_L), &QRcode_free);
    if (!code) return {};
    constexpr int kQuiet = 2;  // Format: light modules around it
    const int width = code->width;
    const auto is_dark = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < width && y < width &&
               (code->data[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x)] &
                1U) != 0;
    };
    std::string lines;
    for (int y = -kQuiet; y < width + kQuiet; y += 2) {
        lines += "\x1b[30;107m";  // black on white
        for (int x = -kQuiet; x < width + kQuiet; ++x) {
            const bool top = is_dark(x, y);
            const bool bottom = is_dark(x, y + 1);
            lines += top ? (bottom ? "█" : "▀") : (bottom ? "▄" : " ");
        }
        lines += "\x1b[0m\n";
    }
    return lines;
}

}  // namespace psfm
