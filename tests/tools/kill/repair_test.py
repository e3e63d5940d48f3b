#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""psfm repair and psfm compact, on sessions that are damaged file by file.

usage: repair_test.py BUILD     (BUILD: build/release)
"""
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

BUILD = Path(sys.argv[1]).resolve()
IMAGES = 14


def psfm(*words, env=None):
    return subprocess.run([BUILD / "psfm", *map(str, words)], capture_output=True, text=True,
                          env={**os.environ, **(env or {})})


def dump(session):
    return subprocess.run([BUILD / "tests/tools/kill/dump_session", session], capture_output=True, text=True,
                          check=True).stdout


def size_of(session):
    return sum(file.stat().st_size for file in session.rglob("*") if file.is_file())


def flip_middle(file):
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 4
    file.write_bytes(content)


class Repair(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="psfm-repair-")
        cls.folder = Path(cls.temporary.name)
        scene = cls.folder / "scene"
        psfm("simulate", "--output", scene, "--scene", "courtyard", "--images", IMAGES)
        cls.database, cls.original = scene / "database.db", cls.folder / "original"
        cls.start = ["import", "--colmap-database", cls.database, "--order", scene / "order.txt", "--deterministic",
                     "--session"]
        assert psfm(*cls.start, cls.original).returncode == 0
        cls.records = dump(cls.original)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def setUp(self):
        self.session = self.folder / "session"
        for folder in self.folder.glob("session*"):
            shutil.rmtree(folder)
        shutil.copytree(self.original, self.session)

    def repair(self, code=0):
        done = psfm("repair", "--session", self.session)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def expect_as_it_was(self):
        self.assertEqual(psfm("check", "--session", self.session).returncode, 0)
        self.assertEqual(dump(self.session), self.records)

    def test_each_table_is_recomputed_but_the_settings(self):
        repaired = 0
        tables = sorted(file.name for file in (self.original / "db").glob("*.sst"))
        self.assertGreaterEqual(len(tables), 9)
        for table in tables:
            self.setUp()
            flip_middle(self.session / "db" / table)
            check = psfm("check", "--session", self.session)
            self.assertEqual(check.returncode, 4, table)
            self.assertIn("psfm repair", check.stderr)
            if "meta" in check.stdout:
                self.assertIn("are lost and cannot be recomputed", self.repair(4).stderr)
                self.assertEqual([folder.name for folder in self.folder.glob("session*")], ["session"])
                continue
            self.assertIn("taken over", self.repair().stdout)
            self.assertTrue((self.folder / "session.damaged/psfm-session").exists(), "nothing is thrown away")
            self.expect_as_it_was()
            repaired += 1
        self.assertEqual(repaired, len(tables) - 1)

    def test_a_database_without_its_index(self):
        (self.session / "db/CURRENT").unlink()
        self.assertEqual(psfm("status", "--session", self.session).returncode, 4)
        self.assertIn(f"taken over: {IMAGES} images", self.repair().stdout)
        self.expect_as_it_was()

    def test_an_image_whose_source_is_gone_is_named(self):
        for table in sorted((self.session / "db").glob("*.sst"), key=lambda file: file.stat().st_size)[-1:]:
            flip_middle(table)  # keypoints
        kept = self.database.read_bytes()
        with sqlite3.connect(self.database) as database:
            for table in ("images", "two_view_geometries"):
                database.execute(f"DELETE FROM {table}")
            database.commit()
            database.execute("VACUUM")
        database.close()
        try:
            done = self.repair(code=1)
        finally:
            self.database.write_bytes(kept)
        lost = [line.split()[1].rstrip(":") for line in done.stdout.splitlines() if line.startswith("LOST")]
        self.assertTrue(lost)
        self.assertIn("is not in the database any more", done.stdout)
        self.assertEqual(psfm("check", "--session", self.session).returncode, 0)
        again = psfm(*self.start, self.session)
        self.assertEqual(again.returncode, 0, again.stderr)
        images = [line for line in dump(self.session).splitlines() if line.startswith("images ")]
        self.assertEqual(len(images), IMAGES, "put back, it is added")

    def test_a_sound_session_is_left_alone(self):
        self.assertIn("nothing to repair", self.repair().stdout)
        self.assertFalse((self.folder / "session.damaged").exists())
        (self.folder / "session.damaged").mkdir()  # of an earlier repair
        self.assertIn("nothing to repair", self.repair().stdout)
        (self.session / "db/CURRENT").unlink()
        self.assertIn("earlier repair", self.repair(3).stderr)
        self.assertEqual(sorted(folder.name for folder in self.folder.glob("session*")), ["session", "session.damaged"])

    def test_what_a_stopped_repair_left_is_told(self):
        (self.folder / "session.repairing").mkdir()
        said = self.repair()
        self.assertIn("nothing to repair", said.stdout)
        self.assertIn("is left of a repair that was stopped", said.stderr)
        self.assertTrue((self.folder / "session.repairing").exists())

    def test_a_session_behind_a_link(self):
        real, link = self.folder / "session-on-a-disk", self.folder / "link"
        self.session.rename(real)
        link.symlink_to(real)
        self.addCleanup(link.unlink)
        (real / "db/CURRENT").unlink()
        self.session = link
        self.repair()
        self.assertTrue(link.is_symlink())
        self.assertTrue((self.folder / "session-on-a-disk.damaged/db").exists(), "on the same file system")
        self.expect_as_it_was()

    def test_compact_gives_space_back(self):
        shutil.rmtree(self.session)
        shim = {"LD_PRELOAD": str(BUILD / "tests/tools/kill/libkill_at_write.so"), "PSFM_KILL_AT": "commit 4 after"}
        for _ in range(8):  # each leaves tables of its own
            psfm(*self.start, self.session, env=shim)
        self.assertEqual(psfm(*self.start, self.session).returncode, 0)
        before = size_of(self.session)
        done = psfm("compact", "--session", self.session)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(size_of(self.session), before)
        self.assertIn(f"{before} bytes before, {size_of(self.session)} after", done.stdout)
        self.expect_as_it_was()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
