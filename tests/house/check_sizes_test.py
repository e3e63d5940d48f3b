#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/ci/check-sizes finds where amounts are compared, refuses too many sizes, and those that nobody names."""
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
    double kept = 0.5;
    bool is_fine(std::size_t placed) const { return placed <= adjust_up_to; }
};
"""
POLICY = "/// The others: {}.\nstruct SolvePolicy {{\n    std::uint32_t mu_max = 5;\n}};\n"


class CheckSizes(unittest.TestCase):
    def run_check(self, *bodies, named="adjust_up_to", options=OPTIONS):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "stages").mkdir()
            (Path(folder) / "stages/growth_options.h").write_text(options)
            (Path(folder) / "stages/solve_policy.h").write_text(POLICY.format(named))
            for index, body in enumerate(bodies):
                (Path(folder) / f"stages/growth_{index}.cpp").write_text(body)
            done = subprocess.run([sys.executable, CHECK, folder], capture_output=True, text=True)
            return done.returncode, done.stdout.splitlines()

    def places(self, body):
        """Without that in the options themselves."""
        _, lines = self.run_check(body)
        return [line for line in lines[:-1] if "growth_options.h" not in line]

    def test_a_comparison_with_a_size_is_found_either_way_round(self):
        self.assertEqual(len(self.places("if (model.size() <= options.adjust_up_to) return;\n")), 1)
        self.assertEqual(len(self.places("if (options.adjust_up_to < images) return;\n")), 1)
        self.assertIn("size: adjust_up_to: stages/growth_0.cpp:2: ",
                      self.places("\nif (images > options.adjust_up_to)\n")[0])

    def test_other_kinds_are_told_from_sizes(self):
        for body, kind in (("if (inliers < options.min_inliers) return;\n", "minimum"),
                           ("while (tried < options.samples) try_one();\n", "bound"),
                           ("taken.resize(std::min(taken.size(), options.samples));\n", "bound"),
                           ("if (static_cast<double>(a.size()) < options.kept * before) f();\n", "part"),
                           ("if (model.images.size() < kFewestOfStart) return;\n", "minimum"),
                           ("if (a.size() <= kLargestRatio * b.size()) return;\n", "part"),
                           ("if (inliers.size() < 3) return;\n", "minimum")):
            self.assertEqual([place.split(":")[0] for place in self.places(body)], [kind], body)

    def test_a_setting_is_followed_to_where_it_is_compared(self):
        for body in ("void f(int n, int enough) {\n    if (n < enough) g();\n}\n"
                     "void h() { f(1, options.adjust_up_to); }\n",
                     "struct A {\n    explicit A(int n) : n_(n) {}\n    bool f(int x) { return x >= n_; }\n"
                     "    int n_;\n};\nvoid h() { A(options.adjust_up_to).f(images); }\n",
                     "void f() {\n    const double most = 2.0 * options.adjust_up_to;\n    if (x < most) g();\n}\n",
                     "void f() {\n    scope.longest_one = options.adjust_up_to;\n}\n"
                     "void g() {\n    if (n < scope.longest_one) h();\n}\n"):
            found = self.places(body)
            self.assertTrue(found and all(place.startswith("size: adjust_up_to: ") for place in found), (body, found))
        self.assertEqual(self.places("void f(int n, int enough) {\n    if (n < enough) g();\n}\n"), [])

    def test_what_calls_a_function_that_asks_for_a_size_is_listed_under_it(self):
        self.assertEqual(self.places("void f() {\n    if (options.is_fine(n)) g();\n}\n"),
                         ["size: adjust_up_to: stages/growth_0.cpp:2: through is_fine: n"])

    def test_a_setting_or_constant_of_no_kind_is_refused(self):
        for body in ("if (found > options.strange_count) return;\n", "if (found.size() > kStrange) return;\n",
                     "if (images.size() > 1000) return;\n"):
            code, lines = self.run_check(body)
            self.assertEqual(code, 1, lines)
            self.assertIn("of no kind", "\n".join(lines))

    def test_other_settings_checks_of_settings_and_comments_are_not(self):
        for body in ("if (error > options.max_error_px) return;\n", "for (int k = 0; k < samples; ++k) f();\n",
                     "if (options.adjust_up_to < 2) return invalid();\n", "// images > options.adjust_up_to\n",
                     "if (options.adjust_up_to < options.samples) return invalid();\n"):
            self.assertEqual(self.places(body), [], body)

    def test_a_size_counts_once(self):
        code, lines = self.run_check(*["if (images > options.adjust_up_to) f();\n"] * 13)
        self.assertEqual(code, 0, lines)
        self.assertTrue(lines[-1].startswith("1 sizes of at most 12;"), lines)

    def test_too_many_are_refused(self):
        for count, expected in ((12, 0), (13, 1)):
            names = [f"in_{chr(97 + k)}_up_to" for k in range(count)]
            options = "struct AOptions {\n" + "".join(f"    int {name} = 1;\n" for name in names) + "};\n"
            body = "".join(f"if (images > options.{name}) f();\n" for name in names)
            code, lines = self.run_check(body, named=", ".join(names), options=options)
            self.assertEqual(code, expected, lines)

    def test_what_the_policy_does_not_name_is_refused(self):
        body = "if (images > options.adjust_up_to) f();\n"
        for named in ("readjust_up_to", "nothing"):
            code, lines = self.run_check(body, named=named)
            self.assertEqual(code, 1, lines)
            self.assertIn("adjust_up_to is a size that neither SolvePolicy has nor the comment above it names", lines)
        self.assertEqual(self.run_check("if (images > policy.mu_max) f();\n")[0], 0)


if __name__ == "__main__":
    unittest.main()
