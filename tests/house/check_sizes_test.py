#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/ci/check-sizes finds where counts are compared with settings, and refuses too many of them that are sizes."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).parents[2] / "tools/ci/check-sizes"
OPTIONS = """struct GrowthOptions {
    std::uint32_t adjust_up_to = 10;
    std::uint32_t min_inliers = 15;
    std::uint32_t samples = 9;
    std::uint32_t strange_count = 9;
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
        self.assertIn("size: stages/growth_0.cpp:2: ", self.places("\nif (images > options.adjust_up_to)\n")[0])

    def test_evidence_and_bounds_are_told_from_sizes(self):
        for body, kind in (("if (inliers < options.min_inliers) return;\n", "evidence"),
                           ("if (found.size() >= min_inliers_) return;\n", "evidence"),
                           ("while (tried < options.samples) try_one();\n", "bound")):
            self.assertTrue(self.places(body)[0].startswith(kind + ": "), body)

    def test_a_setting_of_no_kind_is_refused(self):
        code, lines = self.run_check("if (found > options.strange_count) return;\n")
        self.assertEqual(code, 1, lines)
        self.assertTrue(lines[0].startswith("of no kind"), lines)

    def test_other_settings_checks_of_settings_and_comments_are_not(self):
        for body in ("if (error > options.max_error_px) return;\n", "for (int k = 0; k < samples; ++k) f();\n",
                     "if (options.adjust_up_to < 2) return invalid();\n", "// images > options.adjust_up_to\n"):
            self.assertEqual(self.places(body), [], body)

    def test_too_many_are_refused(self):
        code, lines = self.run_check("if (images > options.adjust_up_to) f();\n")
        self.assertEqual(code, 0, lines)
        code, lines = self.run_check(*["if (images > options.adjust_up_to) f();\n"] * 13)
        self.assertEqual(code, 1, lines)


if __name__ == "__main__":
    unittest.main()
