#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/quickstart: paths are those of the folder that it is called from, and what it prints can be run."""
import shlex
import shutil
import subprocess
import unittest
from pathlib import Path

from folder import Folder

ROOT = Path(__file__).resolve().parents[2]

# What stands in for psfm: it says where it runs and with what words.
PSFM = """#!{python}
import os, sys
with open(os.environ["CALLS"], "a") as calls:
    print(os.getcwd(), *sys.argv[1:], sep="\\t", file=calls)
"""


class Quickstart(Folder):
    def setUp(self):
        super().setUp()
        self.folder = self.folder.resolve()
        for path in ("clone/tools", "clone/build/release", "called from/photos", "bin"):
            (self.folder / path).mkdir(parents=True)
        shutil.copy(ROOT / "tools/quickstart", self.folder / "clone/tools")
        self.psfm = self.program("clone/build/release/psfm", PSFM)
        for name in ("clone/tools/install-packages", "bin/cmake"):
            self.program(name, "#!/bin/sh\n")

    def quickstart(self, *words):
        """@return what it printed, and what psfm was called with: the folder and the words of each call"""
        calls = self.folder / "calls"
        done = subprocess.run([self.folder / "clone/tools/quickstart", *words], cwd=self.folder / "called from",
                              env={"PATH": f"{self.folder}/bin:/usr/bin:/bin", "CALLS": str(calls)},
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout, [line.split("\t") for line in calls.read_text().splitlines()]

    def test_paths_are_of_the_folder_that_it_is_called_from(self):
        _, calls = self.quickstart("photos", "--output", "out", "--", "--dataset", "train")
        here = self.folder / "called from"
        self.assertEqual(calls[0], [str(here), "run", str(here / "photos"), "--session", str(here / "out/session"),
                                    "--dataset", "train"])

    def test_it_says_how_to_make_a_data_set(self):
        said, calls = self.quickstart("photos")
        lines = [shlex.split(line) for line in said.splitlines() if "--format dataset" in line]
        output = Path(calls[0][-1]).parent
        self.assertEqual(output.parent, self.folder / "clone/build/quickstart")
        self.assertEqual(lines, [[str(self.psfm), "export", "--session", str(output / "session"), "--format",
                                  "dataset", "--output", str(output / "dataset")]])


if __name__ == "__main__":
    unittest.main()
