#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Manual pages and completions are what the program says; the service is held down. Usage: manuals_test.py BUILD"""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
BUILD = Path()


class Manuals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        subprocess.run([ROOT / "tools/package/make-manuals", BUILD / "psfm", cls.folder], check=True)
        said = subprocess.run([BUILD / "psfm", "--help"], capture_output=True, text=True, check=True).stdout
        listed = re.split(r"\n(?=\S|\n)", said[said.index("Subcommands:\n") + len("Subcommands:\n"):])[0]
        cls.commands = re.findall(r"^  ([\w-]+)\s", listed, re.MULTILINE)

    def test_every_command_has_a_page(self):
        self.assertIn("localise", self.commands)
        pages = {path.name for path in (self.folder / "man1").iterdir()}
        self.assertEqual(pages, {"psfm.1"} | {f"psfm-{command}.1" for command in self.commands} |
                         {"psfm-vocabulary-train.1"})
        text = (self.folder / "man1/psfm-export.1").read_text()
        self.assertRegex(text, r"^\.TH PSFM-EXPORT 1")
        self.assertIn("\\-\\-reduced", text)
        self.assertIn("\\-\\-words", (self.folder / "man1/psfm-vocabulary-train.1").read_text())

    def test_help_is_a_command(self):
        def said(*words):
            return subprocess.run([BUILD / "psfm", *words], capture_output=True, text=True, check=True).stdout

        self.assertEqual(said("help"), said("--help"))
        self.assertEqual(said("help", "export"), said("export", "--help"))
        self.assertEqual(said("help", "vocabulary", "train"), said("vocabulary", "train", "--help"))
        wrong = subprocess.run([BUILD / "psfm", "help", "nonsense"], capture_output=True, text=True, check=False)
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("there is no command 'nonsense'", wrong.stderr)

    def test_pages_name_pages_that_are_there(self):
        def named(page):
            text = (self.folder / "man1" / page).read_text().replace("\\-", "-")
            return {f"{name}.1" for name in re.findall(r"^\.BR (\S+) \(1\)", text, re.MULTILINE)}

        pages = {path.name for path in (self.folder / "man1").iterdir()}
        for page in pages:
            self.assertLessEqual(named(page), pages - {page}, page)
        self.assertEqual(named("psfm.1"), pages - {"psfm.1", "psfm-vocabulary-train.1"})
        self.assertIn("psfm-resume.1", named("psfm-run.1"))
        self.assertEqual(named("psfm-vocabulary.1"), {"psfm.1", "psfm-vocabulary-train.1"})

    @unittest.skipIf(shutil.which("man") is None, "no man here")
    def test_pages_are_pages(self):
        for name in ("psfm", "psfm-run", "psfm-export", "psfm-vocabulary-train"):
            page = self.folder / f"man1/{name}.1"
            shown = subprocess.run(["man", "--warnings", "-l", page], capture_output=True, text=True, check=True)
            self.assertEqual(shown.stderr, "", name)
            self.assertIn("DESCRIPTION", shown.stdout)

    def completed(self, *words):
        script = (f"source {self.folder}/bash/psfm; COMP_WORDS=({' '.join(map(repr, words))}); "
                  f'COMP_CWORD={len(words) - 1}; _psfm 2>/dev/null; echo "${{COMPREPLY[@]}}"')
        return subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True).stdout.split()

    def test_bash_completes_commands_and_their_options(self):
        self.assertEqual(set(self.completed("psfm", "")), set(self.commands) | {"help", "--help", "--version"})
        self.assertEqual(self.completed("psfm", "loc"), ["localise"])
        self.assertEqual(self.completed("psfm", "export", "--red"), ["--reduced"])
        self.assertIn("--json", self.completed("psfm", "localise", "--"))
        self.assertEqual(self.completed("psfm", "help", "loc"), ["localise"])
        self.assertEqual(set(self.completed("psfm", "vocabulary", "")), {"train", "--help"})
        self.assertEqual(self.completed("psfm", "vocabulary", "train", "--wo"), ["--words"])

    def test_bash_completes_values_that_help_lists(self):
        self.assertEqual(self.completed("psfm", "export", "--format", "colm"),
                         ["colmap", "colmap-text", "colmap-database"])
        self.assertEqual(self.completed("psfm", "export", "--format", "=", "nv"), ["nvm"])
        self.assertIn("gltf", self.completed("psfm", "export", "--format", "="))
        for command, option, value in (("run", "--camera-sharing", "folder"), ("run", "--history", "poses"),
                                       ("import", "--preset", "paper"), ("serve", "--role", "owner"),
                                       ("export", "--image-format", "png"), ("simulate", "--scene", "streets")):
            self.assertIn(value, self.completed("psfm", command, option, ""), option)
        self.assertEqual(self.completed("psfm", "export", "--output", ""), [])

    @unittest.skipIf(shutil.which("zsh") is None, "no zsh here")
    def test_zsh_reads_its_completion(self):
        subprocess.run(["zsh", "-n", self.folder / "zsh/_psfm"], check=True)

    @unittest.skipIf(shutil.which("systemd-analyze") is None, "no systemd-analyze here")
    def test_the_service_is_held_down(self):
        # The threshold is ten times the exposure that systemd-analyze tells.
        judged = subprocess.run(["systemd-analyze", "security", "--offline=yes", "--threshold=20", "--no-pager",
                                 ROOT / "tools/package/psfm.service"], capture_output=True, text=True, check=False)
        self.assertEqual(judged.returncode, 0, judged.stdout[-2000:] + judged.stderr)


if __name__ == "__main__":
    BUILD = Path(sys.argv.pop(1)).resolve()
    unittest.main()
