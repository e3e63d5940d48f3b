#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Links of documents lead to files, here and where they are installed, and docs/README.md lists every page.

usage: documents_test.py BUILD
"""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path()
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)
LINK = re.compile(r"\]\(([^)\s]+)\)")


def links_of(document):
    """The files that a document links to, those of this machine only."""
    links = LINK.findall(CODE.sub("", document.read_text(encoding="utf-8")))
    return [link.split("#")[0] for link in links if not re.match(r"[a-z]+:|#", link)]


def broken_links(folder, documents):
    root = folder.resolve()
    broken = []
    for document in documents:
        for link in links_of(document):
            file = (document.parent / link).resolve()
            if not file.exists() or not file.is_relative_to(root):
                broken.append(f"{document.relative_to(folder)}: {link}")
    return broken


class Documents(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "*.md"], capture_output=True, text=True,
                                check=False)
        if listed.returncode != 0:
            raise unittest.SkipTest("no git, or not its working tree")
        cls.documents = [ROOT / name for name in listed.stdout.split("\0") if name and (ROOT / name).exists()]

    def test_links_lead_to_files(self):
        self.assertGreater(len(self.documents), 50)
        self.assertEqual(broken_links(ROOT, self.documents), [])

    def test_every_page_is_listed(self):
        docs = ROOT / "docs"
        linked = {(docs / link).resolve() for link in links_of(docs / "README.md")}
        pages = {path for path in self.documents if path.is_relative_to(docs)} - {docs / "README.md"}
        self.assertEqual(sorted(str(path.relative_to(docs)) for path in pages - linked), [])


class InstalledDocuments(unittest.TestCase):
    def test_links_lead_to_installed_files(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            subprocess.run(["cmake", "--install", BUILD, "--component", "program", "--prefix", folder], check=True,
                           stdout=subprocess.DEVNULL)
            installed = folder / "share/doc/psfm"
            documents = sorted(installed.rglob("*.md"))
            self.assertIn(installed / "docs/tutorial.md", documents)
            self.assertEqual(broken_links(installed, documents), [])
            empty = [str(path) for path in installed.rglob("*") if path.is_dir() and not any(path.iterdir())]
            self.assertEqual(empty, [])


if __name__ == "__main__":
    BUILD = Path(sys.argv.pop(1)).resolve()
    unittest.main()
