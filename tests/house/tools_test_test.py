#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/test ends with what fails, and tests nothing that could not be built: with programs that only say so."""
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]

# Notes how it was called, and fails where the test wants it to.
STAND_IN = """#!/usr/bin/env bash
echo "$(basename "$0") $*" >> "$CALLS"
if [[ -n "${FAILS:-}" && "$(basename "$0") $*" == $FAILS* ]]; then exit 3; fi
"""


class ToolsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        self.calls_file = self.root / "calls"
        (self.root / "tools").mkdir()
        (self.root / "bin").mkdir()
        shutil.copy(ROOT / "tools/test", self.root / "tools/test")
        for program in ("tools/install-packages", "tools/build-tsan-libraries", "bin/cmake", "bin/ctest"):
            (self.root / program).write_text(STAND_IN)
            (self.root / program).chmod(0o755)

    def run_test(self, *options, fails=""):
        """@return the exit code, and the programs that were called, one a line"""
        path = f"{self.root / 'bin'}:{os.environ['PATH']}"
        done = subprocess.run([self.root / "tools/test", *options], capture_output=True, text=True,
                              env={**os.environ, "PATH": path, "CALLS": str(self.calls_file), "FAILS": fails})
        return done.returncode, self.calls_file.read_text().splitlines()

    def test_builds_and_then_tests(self):
        code, calls = self.run_test()
        self.assertEqual(code, 0)
        self.assertEqual([call.split()[0] for call in calls], ["install-packages", "cmake", "cmake", "ctest"])
        self.assertEqual(calls[1:3], ["cmake --preset release", "cmake --build --preset release"])
        self.assertIn("--preset release", calls[3])

    def test_a_build_that_fails_is_not_tested(self):
        for step in ("cmake --build", "cmake --preset"):
            with self.subTest(step):
                self.calls_file.unlink(missing_ok=True)
                code, calls = self.run_test(fails=step)
                self.assertEqual(code, 3)
                self.assertTrue(calls[-1].startswith(step), calls)

    def test_nor_is_any_preset_after_it(self):
        code, calls = self.run_test("--preset", "all", fails="cmake --build --preset tsan")
        self.assertEqual(code, 3)
        self.assertEqual([call.split()[2] for call in calls if call.startswith("ctest")], ["dev"])
        self.assertNotIn("cmake --build --preset release", calls)

    def test_tests_that_fail_are_its_failure(self):
        code, calls = self.run_test("--preset", "dev", "--preset", "release", fails="ctest --preset dev")
        self.assertEqual(code, 3)
        self.assertTrue(calls[-1].startswith("ctest --preset dev"), calls)

    def test_packages_that_cannot_be_installed_are_the_end(self):
        code, calls = self.run_test(fails="install-packages")
        self.assertEqual((code, len(calls)), (3, 1))

    def test_large_sessions_are_tested_when_asked_for(self):
        for options in ([], ["--fast"], ["--preset", "dev"]):
            self.calls_file.unlink(missing_ok=True)
            self.assertRegex(self.run_test(*options)[1][-1], r" -LE \S*\blarge\b")
        self.calls_file.unlink()
        self.assertRegex(self.run_test("--label", "large")[1][-1], " -L large$")


if __name__ == "__main__":
    unittest.main()
