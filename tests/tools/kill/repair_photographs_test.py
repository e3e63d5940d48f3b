#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""psfm repair of sessions of photographs: of several folders, and of psfm serve with its users.

usage: repair_photographs_test.py BUILD [TEST …]     (BUILD: build/release)
"""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "serve"))
from server import API, Server  # noqa: E402

BUILD = Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else Path()
OF_THE_STORE = {"db", "db-damaged", "psfm-session", "secondary", "writer.lock"}
DAMAGED, BAD_INPUT = 4, 3


def psfm(*words, env=None):
    return subprocess.run([BUILD / "psfm", *map(str, words)], capture_output=True, text=True, check=False,
                          env={**os.environ, **(env or {})})


def render(folder, images):
    """@return the photographs, in order"""
    subprocess.run([BUILD / "tests/synthetic/psfm-render-scene", folder, "--scene", "wall", "--images", str(images),
                    "--width", "400", "--height", "300"], check=True, stdout=subprocess.DEVNULL)
    return sorted((folder / "images").iterdir())


def flip(file):
    content = bytearray(file.read_bytes())
    content[len(content) // 3] ^= 4
    file.write_bytes(content)


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="psfm-repair-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.original, cls.session = cls.folder / "original", cls.folder / "session"

    def setUp(self):
        for folder in self.folder.glob("session*"):
            shutil.rmtree(folder)
        shutil.copytree(self.original, self.session)

    def beside(self, suffix):
        return self.folder / f"session.{suffix}"

    def repair(self, code=0, env=None):
        done = psfm("repair", "--session", self.session, env=env)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr


class SeveralFolders(Case):
    """Four photographs of one card, in two runs, then three of a second card under names that the first has."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        photos = render(cls.folder / "wall", 7)
        first, second = cls.folder / "first", cls.folder / "second"
        for card, taken in (first, photos[:2]), (first, photos[2:4]), (second, photos[4:]):
            card.mkdir(exist_ok=True)
            for photo, name in zip(taken, photos if card == second else taken):
                shutil.copyfile(photo, card / name.name)
            psfm("run", card, "--session", cls.original, "--deterministic")  # of two none is placed at first
        cls.records = cls.dump(cls.original)
        assert len(cls.records) == 4 * 7, cls.records

    @staticmethod
    def dump(session):
        """What is stored of images and pairs; their order does not tell what was solved between two runs."""
        lines = subprocess.run([BUILD / "tests/tools/kill/dump_session", session], capture_output=True, text=True,
                               check=True).stdout.splitlines()
        return [line for line in lines if line.split()[0] in ("images", "keypoints", "descriptors", "pairs")]

    def tables_of(self, kind):
        """Tables of which a flipped byte damages records of that kind first."""
        tables = []
        for table in sorted((self.original / "db").glob("*.sst")):
            self.setUp()
            flip(self.session / "db" / table.name)
            said = psfm("check", "--session", self.session).stdout.splitlines()
            damaged = [line.split()[1] for line in said if line.startswith("DAMAGED")]
            if damaged[:1] == [kind]:
                tables.append(table.name)
        self.setUp()
        self.assertTrue(tables, kind)
        return tables

    def expect_repaired_without(self, table):
        self.setUp()
        flip(self.session / "db" / table)
        self.assertNotIn("LOST", self.repair())
        self.assertEqual(self.dump(self.session), self.records, table)

    def test_what_is_extracted_anew_is_found_in_each_folder(self):
        for table in self.tables_of("keypoints") + self.tables_of("descriptors"):
            self.expect_repaired_without(table)

    def test_names_that_are_lost_are_found_in_their_neighbours_folder(self):
        self.expect_repaired_without(self.tables_of("images")[0])

    def test_another_photograph_of_its_name_is_not_taken_for_it(self):
        table = self.tables_of("keypoints")[0]  # of the very first photographs
        card, elsewhere = self.folder / "first", self.folder / "elsewhere"
        card.rename(elsewhere)
        self.addCleanup(elsewhere.rename, card)
        flip(self.session / "db" / table)
        said = self.repair(1)
        self.assertIn("LOST photo_0000.jpg", said)
        self.assertNotIn("LOST second/", said)

    def test_exports_find_what_was_taken_over(self):
        self.expect_repaired_without(self.tables_of("solutions")[0])
        done = psfm("export", "--session", self.session, "--format", "dataset", "--output", self.folder / "dataset")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(len(list((self.folder / "dataset").glob("**/images/**/*.jpg"))), 7)


class Served(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        added = psfm("serve", "--session", cls.original, "--add-user", "Ada")
        cls.token = added.stdout.split("#token=")[1].split()[0]
        photos = [photo.read_bytes() for photo in render(cls.folder / "wall", 5)]
        server = Server(BUILD, cls.original)
        cls.addClassCleanup(lambda: server.process.poll() is not None or server.stop(signal.SIGKILL))
        for photo in photos[:4]:
            assert server.put(photo, token=cls.token)[0] == 201
        assert server.patch(photos[4], 0, len(photos[4]), len(photos[4]) // 2, token=cls.token)[0] == 204
        cls.wait_for_images(server)
        assert server.ask("GET", f"{API}/images/0/thumbnail", token=cls.token)[0] == 200
        server.stop()
        (cls.original / "log.jsonl").write_text("somebody's own\n")
        cls.kept = cls.files(cls.original)
        assert len(cls.kept) >= 4 + 1 + 4, cls.kept.keys()  # photographs, what has begun, and beside them

    @classmethod
    def wait_for_images(cls, server):
        while server.json("/session", cls.token)["counts"]["placed"] < 4:
            time.sleep(0.1)

    @staticmethod
    def files(session):
        """All that is not the store's own: content and mode by name."""
        found = {file.relative_to(session): file for file in session.rglob("*") if file.is_file()}
        return {str(name): (file.read_bytes(), file.stat().st_mode) for name, file in found.items()
                if name.parts[0] not in OF_THE_STORE}

    def damage(self):
        (self.session / "db/CURRENT").unlink()

    def expect_kept(self):
        files = self.files(self.session)
        self.assertEqual({name for name, file in self.kept.items() if files.get(name) != file}, set())

    def expect_closed(self):
        """Served now, the session lets nobody in without a token. @return whether it can be served"""
        self.expect_kept()
        try:
            server = Server(BUILD, self.session)
        except RuntimeError as error:
            self.assertIn("is damaged", str(error))
            return False
        self.assertEqual(server.ask("GET", API + "/session")[0], 401)
        self.assertEqual(server.ask("GET", API + "/session", token=self.token)[0], 200)
        server.stop()
        return True

    def expect_whole(self):
        self.assertEqual(psfm("check", "--session", self.session).returncode, 0)
        self.assertTrue(self.expect_closed())
        server = Server(BUILD, self.session)
        photographs = server.json("/photographs", self.token)["photographs"]
        server.stop()
        self.assertEqual([photo["state"] for photo in photographs], ["placed"] * 4)
        self.expect_kept()
        self.assertFalse(self.beside("repairing").exists())
        self.assertFalse(self.beside("rebuilt").exists())
        self.assertLessEqual({entry.name for entry in self.beside("damaged").iterdir()}, OF_THE_STORE)

    def test_all_that_is_not_the_database_stays(self):
        self.damage()
        said = self.repair()
        self.assertIn("taken over: 4 images", said)
        self.assertIn(f"its damaged database lies in {self.beside('damaged')} and can be deleted", said)
        self.expect_whole()
        self.assertTrue(list((self.beside("damaged") / "db").glob("*.sst")), "nothing is thrown away")

    def test_a_marker_that_is_damaged(self):
        (self.session / "psfm-session").write_text("psfm sess")
        self.assertFalse(self.expect_closed())
        self.repair()
        self.expect_whole()

    def test_killed_between_any_two_steps(self):
        states = []
        for step in ("1 before", "1 after", "2 after", "3 after", "4 after"):
            self.setUp()
            self.damage()
            self.repair(-signal.SIGKILL, {"LD_PRELOAD": str(BUILD / "tests/tools/kill/libkill_at_write.so"),
                                          "PSFM_KILL_AT": f"move {step}"})
            has_database, has_new = (self.session / "db").exists(), self.beside("repairing").exists()
            states.append((has_database, has_new, self.expect_closed()))
            # A command that looks for the database leaves traces where it was.
            resumed = psfm("resume", "--session", self.session)
            self.assertEqual(resumed.returncode, 0 if states[-1][2] else DAMAGED, resumed.stderr)
            self.repair()
            self.expect_whole()
        self.assertEqual(states, [(True, True, False), (False, True, False), (True, True, True), (True, False, True),
                                  (True, False, True)])

    def test_what_an_earlier_repair_took_along_is_told(self):
        shutil.copytree(self.session, self.beside("damaged"))
        for folder in "photographs", "thumbnails":
            shutil.rmtree(self.session / folder)
        for told in self.repair(), (self.damage(), self.repair(BAD_INPUT))[1]:
            self.assertIn("files that belong to the session: ", told)
            for name in "photographs", "users.json":
                self.assertIn(name, told)
        shutil.rmtree(self.session)
        self.assertIn(f"name that one '{self.session}'", self.repair(BAD_INPUT))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
