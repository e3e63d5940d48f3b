#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/ci/check-sizes finds where what is done depends on how many images there are, and refuses too many of them."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).parents[2] / "tools/ci/check-sizes"
OPTIONS = """struct GrowthOptions {
    std::uint32_t adjust_up_to = 10;
    std::uint32_t min_inliers = 15;
    double max_error_px = 2.0;
};
"""


class CheckSizes(unittest.TestCase):
    def run_check(self, *bodies):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "stages").mkdir()
            (Path(folder) / "stages/growth_options.h").write_text(OPTIONS)
            for index, body in enumerate(bodies):
                (Path(folder) / f"stages/growth_{index}.cpp").write_text(body)
            done = subprocess.run([sys.executable, CHECK, folder], capture_output=True, text=True)
            return done.returncode, done.stdout.splitlines()

    def places(self, body):
        _, lines = self.run_check(body)
        return lines[:-1]

    def test_a_comparison_with_a_size_is_found_either_way_round(self):
        self.assertEqual(len(self.places("if (model.size() <= options.adjust_up_to) return;\n")), 1)
        self.assertEqual(len(self.places("if (options.adjust_up_to < images) return;\n")), 1)
        self.assertIn("stages/growth_0.cpp:2: ", self.places("\nif (images > options.adjust_up_to)\n")[0])

    def test_other_settings_checks_of_settings_and_comments_are_not(self):
        for body in ("if (inliers < options.min_inliers) return;\n", "if (error > options.max_error_px) return;\n",
                     "if (options.adjust_up_to < 2) return invalid();\n", "// images > options.adjust_up_to\n"):
            self.assertEqual(self.places(body), [], body)

    def test_too_many_are_refused(self):
        code, lines = self.run_check("if (images > options.adjust_up_to) f();\n")
        self.assertEqual(code, 0, lines)
        code, lines = self.run_check(*["if (images > options.adjust_up_to) f();\n"] * 13)
        self.assertEqual(code, 1, lines)


if __name__ == "__main__":
    unittest.main()
