#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/ci/check-constants refuses constants that say nothing of themselves, and accepts those that do."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).parents[2] / "tools/ci/check-constants"


class CheckConstants(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.write("int plain(int x) {\n    int y = 3;\n    return x < y ? 7 : 8;\n}\n", "graph/plain.cpp")

    def write(self, body, path="stages/merge/a.cpp"):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(body)

    def run_check(self, *options):
        done = subprocess.run([sys.executable, CHECK, *options, self.root], capture_output=True, text=True)
        return done.returncode, done.stdout

    def assert_accepted(self, body):
        self.write(body)
        code, output = self.run_check()
        self.assertEqual(code, 0, output)

    def assert_refused(self, body, *places):
        """REQUIRES: places are `LINE: NAME`, one a finding."""
        self.write(body)
        code, output = self.run_check()
        self.assertEqual(code, 1, output)
        findings = output.splitlines()
        self.assertEqual(len(findings), len(places), output)
        for finding, place in zip(findings, places):
            self.assertTrue(finding.startswith(f"stages/merge/a.cpp:{place} is a number without a mark"), output)

    def test_without_a_mark(self):
        for declaration in ("constexpr double kLoss = 0.5;", "inline constexpr std::size_t kLoss{5};",
                            "const int kLoss = 12;", "static const float kLoss = 2.F * kOther;",
                            "constexpr std::array<double, 2> kLoss{1.0,\n    2.0};", "constexpr auto kLoss = 100ms;",
                            "constexpr int kLoss =\n    4'000;", "constexpr std::uint8_t kLoss[] = {0xFF};",
                            "const double kLoss = std::hypot(36.0, 24.0);"):
            self.assert_refused(declaration + "\n", "1: kLoss")
        self.assert_refused("// More of it is worse.\nconstexpr int kLoss = 5;  // [px]. Ours.\n", "2: kLoss")
        self.assert_refused("void f() {\n    const double loss = 0.25;\n}\n", "2: loss")
        self.assert_refused("class A {\n    static constexpr int kB = 1, kC = 2;\n};\n", "2: kB", "2: kC")

    def test_with_a_mark(self):
        for mark in ("Format", "Mathematics", "Guard"):
            self.assert_accepted(f"/// {mark}: for a reason.\nconstexpr int kA = 5;\n")
            self.assert_accepted(f"constexpr int kA = 5;  // {mark}: for a reason\n")
            self.assert_accepted(f"/// Of it. {mark}:\n/// for a reason.\nconstexpr int kA = 5;\n")
        self.assert_accepted("constexpr int kA =\n    5;  // Guard: of a long line that goes\n"
                             "        // on below\nconstexpr int kB = 6;  // Guard: for a reason\n")

    def test_reason_and_spelling(self):
        self.assert_refused("constexpr int kA = 5;  // Guard:\n", "1: kA")
        self.assert_refused("constexpr int kA = 5;  // Guard: yes\n", "1: kA")
        self.assert_refused("constexpr int kA = 5;  // Safeguard: for a reason\n", "1: kA")
        self.assert_refused('const char* kA = "Guard: for a reason";\nconstexpr int kB = 5;\n', "2: kB")

    def test_a_mark_covers_adjacent_lines(self):
        self.assert_accepted("/// Format: tags of TIFF.\nconstexpr int kA = 5;\nconstexpr int kB = 6;  // a width\n"
                             "constexpr int kC = kA + kB;\nconstexpr int kD =\n    7;\n")
        self.assert_refused("/// Format: tags of TIFF.\nconstexpr int kA = 5;\n\nconstexpr int kB = 6;\n", "4: kB")
        self.assert_refused("constexpr int kA = 5;  // Format: tag of TIFF\nconstexpr int kB = 6;\n", "2: kB")
        self.assert_refused("constexpr int kA = 5;\nconstexpr int kB = 6;  // Format: tag of TIFF\n", "1: kA")
        self.assert_refused("/// Format: of TIFF.\nconstexpr int kA = 5;\n/// Two.\nconstexpr int kB = 6;\n", "4: kB")

    def test_option_structs(self):
        body = "struct {} {{\n    static constexpr int kMost = 5;\n    double loss = 0.5;\n}};\n"
        for name in ("MergeOptions", "NoiseBounds", "RetrySchedule", "HttpLimits final : Base"):
            self.assert_accepted(body.format(name))
        self.assert_refused(body.format("Merge"), "2: kMost")
        self.assert_refused(body.format("MergeOptions") + "constexpr int kA = 5;\n", "5: kA")
        self.write("constexpr std::array kTable{Range{0, 5}};\n", "scheduler/session/options_of_solving.cpp")
        self.assert_accepted("")

    def test_what_is_no_constant(self):
        self.assert_accepted('constexpr std::string_view kName = "5";\nconstexpr std::array kNames{"1"sv, "2"sv};\n'
                             "constexpr int next(int x) {\n    return x + 1;\n}\n"
                             "constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();\n"
                             "const double width = 2.0 * x;\nconst auto& first = rows[0];\n"
                             "// constexpr int kA = 5;\nvoid f(int a,\n       const int b = 5);\n"
                             'const char* kPage = R"(\nconst int a = 5;\n)";\n')
        self.write("constexpr int kA = 5;\n", "stages/tests/a.cpp")
        self.write("constexpr int kA = 5;\n", "tests/a.cpp")
        self.assertEqual(self.run_check()[0], 0)

    def test_what_is_tuned_is_an_option(self):
        self.write("constexpr int kB = 5;  // Tunable: ours, measured\n", "tools/b.h")
        code, output = self.run_check()
        self.assertEqual(code, 1, output)
        self.assertIn("tools/b.h:1: kB is a number without a mark", output)

    def test_lists(self):
        self.write("/// Format: tags of TIFF.\nconstexpr int kA = 5;\nconstexpr int kB = 6;  // Guard: of a loop\n")
        lines = self.run_check("--list")[1].splitlines()
        self.assertEqual(lines[:2], ["Format (1)", "  stages/merge/a.cpp:2: kA: tags of TIFF."])
        self.assertIn("  stages/merge/a.cpp:3: kB: of a loop", lines)

    def test_literals(self):
        self.write("bool f(double x) {\n    if (x > 0.3) return true;\n    if (x < 12 || x == 1) return false;\n"
                   "    return x > 2.0 && (1U << 12U) != 0 && x < kMost;\n}\n")
        code, output = self.run_check("--literals")
        self.assertEqual(code, 0)
        self.assertEqual([line.split(" ")[0] for line in output.splitlines()],
                         ["stages/merge/a.cpp:2:", "stages/merge/a.cpp:3:"])

    def test_empty_tree_is_no_success(self):
        with tempfile.TemporaryDirectory() as empty:
            self.root = Path(empty)
            self.assertEqual(self.run_check()[0], 1)


if __name__ == "__main__":
    unittest.main()
