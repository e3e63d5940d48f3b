#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What others have, taken over and gone on with; photographs localised. Usage: exchange_test.py BUILD [TEST …]"""
import hashlib
import json
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

BUILD = Path()
BAD_INPUT = 3
IMAGES = 12


def files_of(folder):
    """Every file with its content."""
    return {path.relative_to(folder): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(folder.rglob("*")) if path.is_file()}


def names_in(model):
    """Ids and names of images.bin."""
    data = (model / "images.bin").read_bytes()
    (count,), at, found = struct.unpack_from("<Q", data), 8, {}
    for _ in range(count):
        (image,) = struct.unpack_from("<I", data, at)
        end = data.index(b"\0", at + 64)
        found[image] = data[at + 64:end].decode()
        (features,) = struct.unpack_from("<Q", data, end + 1)
        at = end + 9 + 24 * features
    return found


def colours_in(ply):
    """Red, green and blue of all points."""
    data = ply.read_bytes()
    begin = data.index(b"end_header\n") + len(b"end_header\n")
    return [data[at + 12:at + 15] for at in range(begin, len(data), 15)]


class Exchange(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.shared = Path(folder.name)
        subprocess.run([BUILD / "tests/synthetic/psfm-render-scene", cls.shared / "wall", "--scene", "wall", "--images",
                        str(IMAGES), "--width", "480", "--height", "360"], check=True, stdout=subprocess.DEVNULL)
        cls.names = sorted(path.name for path in (cls.shared / "wall/images").iterdir())
        # Every other photograph is the session of the others' program; the rest come later.
        cls.photos(cls.shared / "half", cls.names[::2])
        cls.ends(0, "run", cls.shared / "half", "--session", cls.shared / "session", "--deterministic")
        cls.ends(0, "export", "--session", cls.shared / "session", "--format", "colmap", "--output", cls.shared / "model")
        cls.ends(0, "export", "--session", cls.shared / "session", "--format", "colmap-database", "--output",
                 cls.shared / "db")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.session = self.folder / "session"

    @classmethod
    def photos(cls, folder, names):
        folder.mkdir(exist_ok=True)
        for name in names:
            shutil.copy(cls.shared / "wall/images" / name, folder / name)
        return folder

    @staticmethod
    def ends(code, *words):
        """Runs psfm; it has to end with that exit code. @return what it said"""
        done = subprocess.run([BUILD / "psfm", *map(str, words)], capture_output=True, text=True, check=False)
        assert done.returncode == code, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
        return done.stdout + done.stderr

    def status(self):
        return json.loads(self.ends(0, "status", "--session", self.session, "--json"))

    def database(self, *statements):
        """A copy of the database, changed."""
        file = self.folder / "changed.db"
        shutil.copy(self.shared / "db/database.db", file)
        with sqlite3.connect(file) as connection:
            for statement in statements:
                connection.execute(*statement)
        connection.close()
        return file

    def outlier_cameras(self):
        said = self.ends(0, "evaluate", "--reference", self.shared / "wall/gt", "--session", self.session, "--json")
        return json.loads(said)["models"][0]["outliers"]

    def test_a_model_is_gone_on_with(self):
        photos = self.photos(self.folder / "photos", self.names[::2])
        said = self.ends(0, "import", "--session", self.session, "--colmap-model", self.shared / "model/0", "--images",
                         photos, "--colmap-database", self.shared / "db/database.db")
        self.assertIn(f"taken over: {IMAGES // 2} images", said)
        before = names_in(self.shared / "model/0")
        self.photos(photos, self.names)
        self.ends(0, "run", photos, "--session", self.session)
        self.assertEqual(self.status()["placed"], IMAGES)
        self.assertEqual(self.outlier_cameras(), 0)
        self.ends(0, "export", "--session", self.session, "--format", "colmap", "--output", self.folder / "again")
        after = names_in(self.folder / "again/0")
        self.assertEqual(len(after), IMAGES)
        self.assertEqual({image: after[image] for image in before}, before)

    def test_without_its_database_features_come_from_the_photographs(self):
        photos = self.photos(self.folder / "photos", self.names)
        self.ends(0, "import", "--session", self.session, "--colmap-model", self.shared / "model/0", "--images", photos)
        self.assertEqual(self.status()["placed"], IMAGES)
        self.assertEqual(self.outlier_cameras(), 0)

    def test_a_database_whose_matcher_has_not_run_says_so(self):
        file = self.database(("DELETE FROM two_view_geometries",))
        said = self.ends(BAD_INPUT, "import", "--session", self.session, "--colmap-database", file)
        self.assertIn("its matcher has not run", said)
        self.assertIn(str(file), said)
        self.assertFalse(self.session.exists())

    def test_a_database_without_images_says_so(self):
        file = self.database(("DELETE FROM images",))
        said = self.ends(BAD_INPUT, "import", "--session", self.session, "--colmap-database", file)
        self.assertIn(f"{file} has no images", said)
        self.assertFalse(self.session.exists())

    def test_a_database_beside_a_model_has_to_be_its_own(self):
        model = ("import", "--session", self.session, "--colmap-model", self.shared / "model/0", "--images",
                 self.shared / "half", "--colmap-database")
        said = self.ends(BAD_INPUT, *model, self.database(("UPDATE images SET name = 'other/' || name",)))
        self.assertIn(f"lacks {self.names[0]} and {IMAGES // 2 - 1} more of the model's {IMAGES // 2} images", said)
        said = self.ends(BAD_INPUT, *model, self.database(("DELETE FROM two_view_geometries",)))
        self.assertIn("its matcher has not run", said)
        self.assertIn("leave --colmap-database out", said)
        self.assertFalse(self.session.exists())
        # One that has some is told.
        said = self.ends(0, *model, self.database(("UPDATE images SET name = 'other' WHERE name = ?", self.names[:1])))
        self.assertIn(f"changed.db lacks {self.names[0]} of the model's", said)

    def test_a_name_that_no_folder_can_have_is_a_photograph_less(self):
        name = "a" * 300 + ".jpg"
        file = self.database(("UPDATE images SET name = ? WHERE name = ?", (name, self.names[0])))
        said = self.ends(0, "import", "--session", self.session, "--colmap-database", file, "--images", self.shared / "half")
        self.assertIn(f"lacks {name} (File name too long)", said)
        self.assertEqual(self.status()["placed"], IMAGES // 2)

    def test_descriptors_of_others_are_passed_over(self):
        # ALIKED's, as COLMAP 4 stores them: 128 floats.
        file = self.database(("UPDATE descriptors SET cols = 512, data = zeroblob(rows * 512)",))
        self.ends(0, "import", "--session", self.session, "--colmap-database", file)
        self.assertEqual(self.status()["placed"], IMAGES // 2)

    def test_photographs_give_an_import_its_colours(self):
        colours = {}
        for given in (False, True):
            session = self.folder / f"session{given}"
            images = ["--images", self.shared / "half"] if given else []
            self.ends(0, "import", "--session", session, "--colmap-database", self.shared / "db/database.db", *images)
            self.ends(0, "export", "--session", session, "--format", "ply", "--points-only", "--output",
                      self.folder / f"ply{given}")
            colours[given] = set(colours_in(self.folder / f"ply{given}/0.ply"))
        self.assertEqual(len(colours[False]), 1)
        self.assertGreater(len(colours[True]), 100)
        # ... and exports that need them find them.
        self.ends(0, "export", "--session", self.folder / "sessionTrue", "--format", "dataset", "--output",
                  self.folder / "data")
        self.assertEqual(len(list((self.folder / "data/0/images").iterdir())), IMAGES // 2)

    def test_photographs_become_a_data_set_by_one_command(self):
        photos = self.photos(self.folder / "photos", self.names[:8])
        said = self.ends(0, "run", photos, "--session", self.session, "--dataset", self.folder / "train")
        self.assertIn("train/0", said)
        pictures = sorted(path.name for path in (self.folder / "train/0/images").iterdir())
        self.assertEqual(pictures, self.names[:8])
        self.assertEqual(sorted(names_in(self.folder / "train/0/sparse/0").values()), pictures)
        # None where there is nothing to write.
        few = self.photos(self.folder / "few", self.names[:2])
        self.ends(BAD_INPUT, "run", few, "--session", self.folder / "other", "--dataset", self.folder / "none")
        self.assertFalse((self.folder / "none").exists())
        self.assertIn("advice    its cluster has too few images: ", self.ends(0, "status", "--session", self.folder / "other"))
        # What came by `psfm serve` lies in the session itself.
        shutil.move(photos, self.session / "photographs")
        self.ends(0, "export", "--session", self.session, "--format", "dataset", "--output", self.folder / "served")
        self.assertEqual(len(list((self.folder / "served/0/images").iterdir())), 8)

    def test_a_data_set_below_the_photographs_is_none_of_them(self):
        photos = self.photos(self.folder / "photos", self.names[:8])
        command = ("run", photos, "--session", self.session, "--dataset", photos / "train")
        self.ends(0, *command, "--reduced", "2", "2", "3", "--max-size", "300")
        self.assertEqual(sorted(path.name for path in (photos / "train/0").glob("images_*")), ["images_2", "images_3"])
        self.photos(photos, self.names[8:10])
        # What was reduced stays so, unless something else is asked for.
        self.ends(0, *command)
        self.assertEqual(self.status()["images"], 10)
        self.assertEqual(len(list((photos / "train/0/images_3").iterdir())), self.status()["placed"])
        self.assertIn(" max 300 ", (photos / "train/0/.psfm-dataset.json").read_text())

    def test_a_session_takes_in_no_model_later(self):
        model = ("--colmap-model", self.shared / "model/0", "--images", self.shared / "half")
        beside = self.folder / "session.importing"
        beside.mkdir()
        (beside / "mine").write_text("precious")
        self.ends(0, "import", "--session", self.session, *model)
        self.assertTrue((beside / "mine").exists())
        said = self.ends(0, "import", "--session", self.session, *model)
        self.assertIn("is not read again", said)
        said = self.ends(BAD_INPUT, "import", "--session", self.session, *model[:3], self.folder / "nowhere")
        self.assertIn("no such folder", said)
        said = self.ends(BAD_INPUT, "import", "--session", self.shared / "session", *model)
        self.assertIn("did not begin with a COLMAP model", said)
        said = self.ends(BAD_INPUT, "import", "--session", beside, *model)
        self.assertIn("is not a psfm session; choose an empty or new folder", said)

    def test_photographs_of_others_are_told(self):
        others = self.folder / "others"
        others.mkdir()
        for name, other in zip(self.names[::2], self.names[:0:-2]):
            shutil.copy(self.shared / "wall/images" / other, others / name)
        said = self.ends(0, "import", "--session", self.session, "--colmap-model", self.shared / "model/0", "--images", others)
        self.assertIn("hardly show what the model has of them: are they those", said)
        self.session = self.folder / "right"
        said = self.ends(0, "import", "--session", self.session, "--colmap-model", self.shared / "model/0", "--images",
                         self.shared / "half")
        self.assertNotIn("hardly", said)

    def test_a_database_that_cannot_be_read_leaves_no_session(self):
        file = self.database(("UPDATE two_view_geometries SET rows = rows + 1 WHERE rowid = "
                              "(SELECT rowid FROM two_view_geometries ORDER BY rowid LIMIT 1)",))
        said = self.ends(BAD_INPUT, "import", "--session", self.session, "--colmap-database", file)
        self.assertIn("two_view_geometries, row", said)
        self.assertFalse(self.session.exists())

    def test_photographs_that_came_later_make_a_data_set(self):
        self.ends(0, "import", "--session", self.session, "--colmap-database", self.shared / "db/database.db")
        self.ends(0, "export", "--session", self.session, "--format", "dataset", "--output", self.folder / "data",
                  "--images", self.shared / "half")
        self.assertEqual(len(list((self.folder / "data/0/images").iterdir())), IMAGES // 2)

    def localised(self, session, *photos):
        said = self.ends(0, "localise", "--session", session, *photos, "--json")
        return json.loads(said[said.index("{"):])["photos"]

    def test_localising_changes_nothing(self):
        before = files_of(self.shared / "session")
        others = [self.shared / "wall/images" / name for name in self.names[1:-1:2]]
        blank = self.folder / "blank.pgm"
        blank.write_bytes(b"P5 320 240 255\n" + bytes(320 * 240))
        found = self.localised(self.shared / "session", *others, blank)
        self.assertEqual(files_of(self.shared / "session"), before)
        self.assertEqual([photo["localised"] for photo in found], [True] * len(others) + [False])
        self.assertNotEqual(found[-1]["reason"], "")
        for photo, number in zip(found, range(1, IMAGES - 1, 2)):
            self.assertGreater(photo["inliers"], 50)
            self.assertEqual([len(row) for row in photo["covariance"]], [6] * 6)
            # It sees its neighbours on the walk.
            self.assertIn(photo["images"][0]["name"], (self.names[number - 1], self.names[number + 1]))

    def test_an_import_lends_its_camera_to_who_is_localised(self):
        with_other_lens = self.database(("UPDATE cameras SET model = 2, prior_focal_length = 1, params = ?",
                                         (struct.pack("<4d", 500, 240, 180, -0.02),)))
        self.ends(0, "import", "--colmap-database", with_other_lens, "--session", self.session, "--fix-intrinsics")
        self.assertEqual(self.status()["placed"], len(self.names[::2]))
        found = self.localised(self.session, self.shared / "wall/images" / self.names[1])[0]
        self.assertEqual(found["camera"]["model"], "SIMPLE_RADIAL")
        self.assertAlmostEqual(found["camera"]["params"][3], -0.02)

    def test_a_folder_without_photographs_keeps_no_other_from_being_localised(self):
        empty = self.folder / "empty"
        empty.mkdir()
        found = self.localised(self.shared / "session", empty, self.shared / "wall/images" / self.names[1])
        self.assertEqual([photo["localised"] for photo in found], [False, True])
        self.assertIn("holds no photographs", found[0]["reason"])
        said = self.ends(BAD_INPUT, "localise", "--session", self.shared / "session", empty)
        self.assertIn(f"{empty}: not localised: holds no photographs", said)

    def test_localising_works_beside_a_writer(self):
        photos = self.photos(self.folder / "photos", self.names[::2])
        with subprocess.Popen([BUILD / "psfm", "run", photos, "--session", self.session, "--watch"],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as writer:
            try:
                deadline = time.monotonic() + 120
                placed = 0
                while placed < IMAGES // 2 and time.monotonic() < deadline:
                    time.sleep(0.5)
                    if (self.session / "db").exists() or any(self.session.glob("*")):
                        done = subprocess.run([BUILD / "psfm", "status", "--session", self.session, "--json"],
                                              capture_output=True, text=True, check=False)
                        placed = json.loads(done.stdout)["placed"] if done.returncode == 0 else 0
                self.assertEqual(placed, IMAGES // 2)
                found = self.localised(self.session, self.shared / "wall/images" / self.names[3])
                self.assertIsNone(writer.poll())
            finally:
                writer.send_signal(signal.SIGINT)
        self.assertTrue(found[0]["localised"])
        self.assertEqual(writer.returncode, 0)


if __name__ == "__main__":
    BUILD = Path(sys.argv.pop(1)).resolve()
    unittest.main()
