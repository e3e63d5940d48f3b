#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sessions that are gone on with from the command line: what holds, what may change, and what a mistaken
command leaves as it was. Usage: go_on_test.py BUILD [TEST …]"""
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock
from pathlib import Path

BUILD = Path()
BAD_INPUT, USAGE = 3, 2


def psfm(*words):
    """@return exit code, stdout and stderr"""
    done = subprocess.run([BUILD / "psfm", *map(str, words)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


class GoOn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.shared = Path(folder.name)
        assert psfm("simulate", "--scene", "courtyard", "--images", 14, "--output", cls.shared / "scene")[0] == 0
        subprocess.run([BUILD / "tests/synthetic/psfm-render-scene", cls.shared / "wall", "--scene", "wall", "--images", "6",
                        "--width", "400", "--height", "300"], check=True, stdout=subprocess.DEVNULL)

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.session = self.folder / "session"

    def database(self):
        return "--colmap-database", self.shared / "scene/database.db", "--session", self.session

    def ends(self, code, *words):
        """Runs psfm; it has to end with that exit code. @return what it said"""
        ended, said = psfm(*words)
        self.assertEqual(ended, code, said)
        self.assertNotIn("terminate", said)
        return said

    def wall(self):
        photos = self.folder / "photos"
        shutil.copytree(self.shared / "wall/images", photos)
        return photos

    def images(self):
        return json.loads(self.ends(0, "status", "--session", self.session, "--json"))["images"]

    def test_an_order_that_cannot_be_followed_changes_nothing(self):
        order = self.folder / "order.txt"
        order.write_text("nobody.jpg\n")
        self.assertIn("nobody.jpg", self.ends(BAD_INPUT, "import", *self.database(), "--order", order))
        self.assertFalse(self.session.exists())
        self.ends(0, "import", *self.database())
        self.ends(BAD_INPUT, "import", *self.database(), "--order", order)
        self.ends(0, "resume", "--session", self.session)

    def test_a_mistyped_vocabulary_can_be_put_right(self):
        photos = self.folder / "photos"
        photos.mkdir()
        (photos / "a.jpg").write_text("no photograph")
        missing = self.folder / "nowhere.psfm"
        run = "run", photos, "--session", self.session
        said = self.ends(BAD_INPUT, *run, "--vocabulary", missing)
        self.assertIn(str(missing), said)
        self.assertIn("psfm vocabulary train", said)
        self.assertFalse(self.session.exists())
        self.session.mkdir()
        self.ends(BAD_INPUT, *run, "--vocabulary", missing)
        self.assertEqual(list(self.session.iterdir()), [], "an empty folder stays empty")
        self.assertIn("a.jpg: is not an image", self.ends(BAD_INPUT, *run))
        missing.write_text("no vocabulary")
        self.assertIn(str(missing), self.ends(BAD_INPUT, *run, "--vocabulary", missing))

    def test_large_sessions_use_the_vocabulary_of_the_user(self):
        photos = self.wall()
        words = self.folder / "data/psfm/vocabulary"
        with unittest.mock.patch.dict(os.environ, {"XDG_DATA_HOME": str(self.folder / "data")}):
            os.environ.pop("PSFM_VOCABULARY", None)
            self.assertIn(str(words), self.ends(0, "vocabulary", "train", photos, "--words", 50))
            large = "--set", "retrieval.candidates=3", "--set", "retrieval.max_training_images=2"
            run = "run", photos, "--session", self.session
            self.ends(0, *run, *large)
            self.assertEqual(self.images(), 6)  # the seventh is looked up with other words
            (photos / "again.jpg").write_bytes(next(photos.iterdir()).read_bytes() + b"not the same")
            self.ends(0, "run", photos, "--session", self.folder / "with-it", *large)
            words.write_bytes(words.read_bytes()[:-1] + b"x")
            self.assertIn(str(words), self.ends(BAD_INPUT, *run))
            self.ends(0, "run", photos, "--session", self.folder / "deterministic", "--deterministic", *large)
            os.environ["PSFM_VOCABULARY"] = ""
            self.ends(0, *run)
            self.assertEqual(self.images(), 7)

    def test_a_log_that_cannot_be_written_changes_nothing(self):
        self.assertIn("there is no folder", self.ends(1, "import", *self.database(), "--log", self.folder / "none/log"))
        self.assertFalse(self.session.exists())
        self.ends(1, "import", *self.database(), "--log", self.folder, "--seed", 3)
        self.ends(0, "import", *self.database())
        self.ends(BAD_INPUT, "import", *self.database(), "--seed", 3)

    def test_a_log_may_lie_in_the_session(self):
        self.ends(0, "import", *self.database(), "--log", self.session / "log.jsonl")
        self.assertIn('"event":"image"', (self.session / "log.jsonl").read_text())

    def test_a_full_disk_behind_what_is_printed_is_told(self):
        self.ends(0, "import", *self.database())
        for words in ("status", "--session", self.session, "--json"), ("options", "--markdown"), ("--help",):
            with open("/dev/full", "w", encoding="utf8") as full:
                done = subprocess.run([BUILD / "psfm", *words], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
            self.assertEqual(done.returncode, 1, words)
            self.assertIn("cannot be written", done.stderr)

    def test_what_is_left_out_is_as_it_was(self):
        self.ends(0, "import", *self.database(), "--fix-intrinsics", "--seed", 3, "--preset", "paper")
        self.ends(0, "import", *self.database())
        self.ends(0, "import", *self.database(), "--seed", 3)
        self.assertIn("another --seed", self.ends(BAD_INPUT, "import", *self.database(), "--seed", 4))
        self.assertIn("another --preset", self.ends(BAD_INPUT, "import", *self.database(), "--preset", "default"))

    def test_options_of_the_stages_are_as_they_were_whatever_they_are_called(self):
        # hold_from is no more: a part of join_up_to by now.
        begun = "--set", "clustering.hold_from=7", "--set", "clustering.join_up_to=25"
        self.ends(0, "import", *self.database(), *begun)
        self.ends(0, "import", *self.database(), *begun)
        self.ends(0, "import", *self.database(), "--set", "clustering.hold_part=0.28")
        for other in "clustering.hold_from=8", "clustering.hold_part=0.3", "clustering.eta=0.3":
            self.assertIn("another --set " + other.split("=", maxsplit=1)[0],
                          self.ends(BAD_INPUT, "import", *self.database(), "--set", other))

    def test_resume_keeps_the_history_that_was_asked_for(self):
        log = self.folder / "log"
        with subprocess.Popen([BUILD / "psfm", "import", *self.database(), "--history", "full", "--deterministic", "--log",
                               log], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
            while process.poll() is None and (not log.exists() or log.read_text().count('"event":"image"') < 5):
                time.sleep(0.005)
            process.send_signal(signal.SIGINT)
            said = process.communicate()[1]
        if process.returncode != 0:  # else it was faster than this test
            self.assertIn(f"psfm resume --session {self.session}", said)
            self.ends(0, "resume", "--session", self.session)
        for image in (10, 12):
            said = self.ends(0, "export", "--session", self.session, "--format", "colmap", "--after-image", image, "--output",
                             self.folder / f"model{image}")
            self.assertNotIn("only poses", said)

    def test_versions_that_go_are_told(self):
        self.ends(0, "import", *self.database(), "--history", "full", "--deterministic")
        self.assertNotIn("--history none", self.ends(0, "import", *self.database()))
        self.assertRegex(self.ends(0, "import", *self.database(), "--history", "none"), r"--history none: \d+ earlier versions")
        self.assertNotIn("--history none", self.ends(0, "import", *self.database()))  # none is left to go

    def test_files_that_the_session_has_may_be_gone(self):
        photos = self.wall()
        order = self.folder / "order.txt"
        names = sorted(photo.name for photo in photos.iterdir())
        order.write_text("\n".join(names[:5]))
        run = "run", photos, "--session", self.session
        self.ends(0, *run, "--order", order)
        (photos / names[0]).unlink()
        order.write_text("\n".join(names))
        self.ends(0, *run, "--order", order)
        self.assertEqual(self.images(), 6)
        shutil.rmtree(photos)
        self.assertIn("going on with what the session has", self.ends(0, "resume", "--session", self.session))
        self.assertIn("no such folder", self.ends(BAD_INPUT, *run))

    def test_what_the_system_refused_is_looked_at_again(self):
        photos = self.wall()
        gone = sorted(photos.iterdir())[2]
        (photos / "link.jpg").symlink_to("/proc/self/mem")  # cannot be read, and never changes
        run = "run", photos, "--session", self.session
        self.assertIn("link.jpg", self.ends(0, *run))
        self.assertIn("link.jpg", self.ends(0, *run))
        (photos / "link.jpg").unlink()
        (photos / "link.jpg").write_bytes(gone.read_bytes() + b"not the same")
        self.ends(0, *run)
        self.assertEqual(self.images(), 7)

    def test_a_folder_that_is_not_there_is_not_watched(self):
        nowhere = self.folder / "nowhere"
        self.assertIn(f"{nowhere}: there is no such folder",
                      self.ends(BAD_INPUT, "run", nowhere, "--session", self.session, "--watch"))
        self.assertFalse(self.session.exists())

    def test_what_is_in_the_way_of_an_output_is_named(self):
        file = self.folder / "file.txt"
        file.write_text("mine")
        self.assertIn(f"{file} is a file", self.ends(BAD_INPUT, "simulate", "--images", 12, "--output", file))
        self.assertIn("there is no psfm session in", self.ends(BAD_INPUT, "compact", "--session", file))
        self.assertIn("there is no psfm session in", self.ends(BAD_INPUT, "resume", "--session", file))
        self.ends(0, "import", *self.database())
        export = "export", "--session", self.session, "--format", "colmap", "--output"
        (self.folder / "model").mkdir()
        (self.folder / "model/0").write_text("mine")
        self.assertIn("model/0", self.ends(BAD_INPUT, *export, self.folder / "model"))
        self.assertEqual((self.folder / "model/0").read_text(), "mine")
        self.ends(USAGE, *export, self.folder / "model0", "--after-image", 0)
        self.assertIn("14 images", self.ends(0, *export, self.folder / "model1", "--after-image", 99))

    def test_a_command_that_does_not_exist_is_named(self):
        self.assertIn("'reconstruct'", self.ends(USAGE, "reconstruct", "--session", self.session))

    def test_numbers_below_zero_are_no_numbers_of_things(self):
        for words in (("run", self.folder, "--session", self.session, "--seed", -1),
                      ("run", self.folder, "--session", self.session, "--shuffle", -1),
                      ("run", self.folder, "--session", self.session, "--shuffle", 2**64),
                      ("import", *self.database(), "--seed", -1),
                      ("export", "--session", self.session, "--format", "dataset", "--output", self.folder, "--part", -1),
                      ("simulate", "--output", self.folder, "--seed", -1),
                      ("simulate", "--output", self.folder, "--images", -1)):
            said = self.ends(USAGE, *words)
            self.assertIn(f"{words[-2]}", said)
        self.assertFalse(self.session.exists())

    def test_empty_values_are_refused(self):
        view = "view", "--session", self.session
        self.ends(USAGE, *view, "--output=")
        for words in ((*view, "--output", ""), ("run", "", "--session", self.session),
                      ("run", self.folder, "--session", ""), ("run", self.folder, "--session", self.session, "--masks", ""),
                      ("import", *self.database(), "--images", ""), ("remove", "--session", self.session, "a.jpg", ""),
                      ("localise", "--session", self.session, ""), ("vocabulary", "train", ""), ("doctor", "--folder", ""),
                      ("evaluate", "--reference", "", "--session", self.session)):
            self.assertIn("empty", self.ends(USAGE, *words))
        self.assertFalse(self.session.exists())


if __name__ == "__main__":
    BUILD = Path(sys.argv.pop(1)).resolve()
    unittest.main()
