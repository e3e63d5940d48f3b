# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the tools share: a folder of their own, and programs that stand in for psfm."""
import os
import stat
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

# A stand-in knows its `words`, and the paths that follow options.
PREAMBLE = """#!{python}
import json, sys
from pathlib import Path
words = sys.argv[1:]
def value(name): return Path(words[words.index(name) + 1])
if words == ["--version"]:
    print("0.0")
    sys.exit()
"""


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def program(self, name, text):
        """An executable file; {python} in it is this interpreter."""
        file = self.folder / name
        file.write_text(text.replace("{python}", sys.executable))
        file.chmod(file.stat().st_mode | stat.S_IXUSR)
        return file

    def stand_in(self, text):
        return self.program("psfm", PREAMBLE + text)

    def photographs(self, path, count):
        """Empty files 0.jpg, 1.jpg, … in a folder of the data sets."""
        (self.folder / path).mkdir(parents=True)
        for i in range(count):
            (self.folder / path / f"{i}.jpg").write_text("")

    def run_program(self, program, *arguments):
        """@return exit code, stdout, stderr; the data sets are this folder"""
        environment = {**os.environ, "PSFM_DATASETS": str(self.folder)}
        done = subprocess.run([sys.executable, program, *map(str, arguments)], env=environment, capture_output=True,
                              text=True, check=False)
        return done.returncode, done.stdout, done.stderr
