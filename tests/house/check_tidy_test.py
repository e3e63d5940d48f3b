#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/ci/check-tidy finds a planted bug, and looks again only at what changed."""
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]


@unittest.skipUnless(shutil.which("clang-tidy-19"), "no clang-tidy-19 (tools/install-packages --ci)")
class CheckTidy(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name)
        shutil.copy(ROOT / ".clang-tidy", self.root)
        self.build = self.root / "build/release"
        self.build.mkdir(parents=True)
        (self.root / "graph").mkdir()
        self.header = self.root / "graph/one.h"
        self.header.write_text("#pragma once\nconstexpr int kOne = 1;\n")
        self.source = self.root / "graph/one.cpp"
        self.source.write_text('#include "one.h"\nint one() { return kOne; }\n')
        entry = {"directory": str(self.build), "file": str(self.source), "command": f"c++ -c {self.source}"}
        (self.build / "compile_commands.json").write_text(json.dumps([entry]))

    def run_check(self, *options):
        command = [sys.executable, ROOT / "tools/ci/check-tidy", "--root", self.root, *options]
        done = subprocess.run(command, capture_output=True, text=True)
        return done.returncode, done.stdout

    def test_clean_file_is_remembered_until_a_header_changes(self):
        self.assertIn("1 clean", self.run_check()[1])
        self.assertIn("1 unchanged", self.run_check()[1])
        self.header.write_text("#pragma once\nconstexpr int kOne = 2;\n")
        self.assertIn("0 unchanged", self.run_check()[1])

    def test_a_finding_fails_every_time(self):
        self.source.write_text("int One() { return 1; }\n")
        for _ in range(2):
            code, output = self.run_check()
            self.assertEqual(code, 1)
            self.assertIn("readability-identifier-naming", output)

    def test_time_limit_is_told(self):
        code, output = self.run_check("--seconds", "-1")
        self.assertEqual(code, 0)
        self.assertIn("1 left out", output)


if __name__ == "__main__":
    unittest.main()
