#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photographs as people have them: files of other kinds, second cards, renamed and edited files, previews, masks,
and photographs that are taken out again. Usage: intake_test.py BUILD [TEST …]; the class Cases wants PSFM_DATASETS."""
import json
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

BUILD = Path()
BAD_INPUT = 3


def write_png(file, rows):
    """Grey values, one list a row."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0)
    pixels = b"".join(b"\0" + bytes(row) for row in rows)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b""))


class Sessions(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.session = self.folder / "session"

    def ends(self, code, *words):
        """Runs psfm; it has to end with that exit code. @return what it said"""
        done = subprocess.run([BUILD / "psfm", *map(str, words)], capture_output=True, text=True, check=False)
        said = done.stdout + done.stderr
        self.assertEqual(done.returncode, code, said)
        self.assertNotIn("terminate", said)
        return said

    def run_on(self, photos, *options):
        return self.ends(0, "run", photos, "--session", self.session, *options)

    def status(self):
        return json.loads(self.ends(0, "status", "--session", self.session, "--json"))

    def names(self):
        """Of the images in the model."""
        model = self.folder / "model"
        self.ends(0, "export", "--session", self.session, "--format", "colmap-text", "--output", model)
        lines = [line for line in (model / "0/images.txt").read_text().splitlines() if not line.startswith("#")]
        return sorted(line.split(" ", 9)[9] for line in lines[::2])


class Intake(Sessions):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.shared = Path(folder.name)
        for name, width, height in (("wall", 400, 300), ("small", 200, 150)):
            subprocess.run([BUILD / "tests/synthetic/psfm-render-scene", cls.shared / name, "--scene", "wall", "--images", "7",
                            "--width", str(width), "--height", str(height)], check=True, stdout=subprocess.DEVNULL)

    def wall(self, name="photos"):
        photos = self.folder / name
        shutil.copytree(self.shared / "wall/images", photos)
        return photos, sorted(photo.name for photo in photos.iterdir())

    def test_what_is_not_taken_is_named_by_kind(self):
        photos, _ = self.wall()
        for name in ("a.dng", "b.gif", "c.mp4", "d.MP4", "notes.txt"):
            (photos / name).write_text("x")
        said = self.run_on(photos)
        self.assertIn("1 raw photograph (.dng)", said)
        self.assertIn("2 videos (2 .mp4)", said)
        self.assertIn("(.gif)", said)
        self.assertIn("not taken: 4 files (.dng, .gif, 2 .mp4)", said)
        self.assertNotIn("notes.txt", said)

    def test_other_endings_of_jpeg_and_a_missing_end_marker(self):
        photos, names = self.wall()
        for name, ending in zip(names, (".jfif", ".JPE", ".MPO")):
            (photos / name).rename((photos / name).with_suffix(ending))
        cut = photos / names[5]
        cut.write_bytes(cut.read_bytes()[:-2])
        said = self.run_on(photos)
        self.assertIn(f"note {names[5]}: lacks the marker at its end", said)
        self.assertEqual((self.status()["images"], self.status()["rejected"]), (7, 0))

    def test_order_files_may_begin_with_a_mark(self):
        photos, names = self.wall()
        order = self.folder / "order.txt"
        order.write_bytes(b"\xef\xbb\xbf" + "\r\n".join(names).encode())
        self.run_on(photos, "--order", order)
        self.assertEqual(self.status()["images"], 7)
        order.write_bytes("\n".join(names).encode("utf-16"))
        self.assertIn("UTF-16; save it as UTF-8", self.ends(BAD_INPUT, "run", photos, "--session", self.session, "--order", order))

    def test_a_second_card_with_the_same_names(self):
        photos, names = self.wall("cardA")
        other = self.folder / "cardB"
        other.mkdir()
        for name, taken in zip(names[4:], names):
            (photos / name).rename(other / taken)
        self.run_on(photos)
        self.assertEqual(self.status()["placed"], 4)
        said = self.run_on(other)
        self.assertIn(f"taken in as cardB/{names[0]}, cardB/{names[1]}, cardB/{names[2]}", said)
        self.assertEqual(self.status()["placed"], 7)
        self.assertNotIn("psfm:", self.run_on(other))
        self.assertNotIn("psfm:", self.run_on(photos))
        self.assertEqual(self.status()["images"], 7)
        self.run_on(self.folder / ".", "--order", self.order([f"cardA/{names[0]}"]))
        self.assertEqual(self.names(), sorted([f"cardA/{name}" for name in names[:4]] + [f"cardB/{name}" for name in names[:3]]))

    def order(self, names):
        order = self.folder / "order.txt"
        order.write_text("\n".join(names))
        return order

    def test_names_follow_files_and_edits_are_told(self):
        photos, names = self.wall()
        self.run_on(photos)
        (photos / "sub").mkdir()
        for name in names[:3]:
            (photos / name).rename(photos / "sub" / name)
        said = self.run_on(photos)
        self.assertIn("3 photographs were moved or renamed", said)
        self.assertEqual((self.status()["images"], self.status()["rejected"]), (7, 0))
        self.assertEqual(self.names(), sorted([f"sub/{name}" for name in names[:3]] + names[3:]))
        edited = photos / names[6]
        edited.write_bytes(edited.read_bytes() + b"edited")
        for _ in range(2):
            self.assertIn(f"not taken in: {names[6]}", self.run_on(photos))
        self.assertEqual(self.status()["images"], 7)

    def test_small_copies_cost_nobody_a_place(self):
        photos, names = self.wall()
        shutil.copytree(self.shared / "small/images", photos / "a_small")  # by name before the others
        said = self.run_on(photos)
        self.assertIn(f"a_small/{names[0]} (200x150 px) is a small copy of {names[0]} (400x300 px)", said)
        status = self.status()
        self.assertEqual((status["images"], status["placed"], status["rejected"]), (7, 7, 7))

    def test_masks_are_kept_with_the_session(self):
        photos, names = self.wall()
        masks = photos / "masks"
        rows = [[0] * 400] * 100 + [[255] * 400] * 200
        for name in names[:5]:
            write_png(masks / f"{name}.png", rows)
        write_png(masks / "zebra.png", rows)
        said = self.run_on(photos)
        self.assertIn("6 files in " + str(masks) + " look like masks", said)
        self.assertEqual(self.status()["images"], 7)
        said = self.run_on(photos, "--masks", masks)
        self.assertIn("5 photographs of the session were taken in without the mask", said)
        self.assertIn("MASKS WITHOUT A PHOTOGRAPH", said)
        self.assertIn("zebra.png", said)
        self.ends(0, "remove", "--session", self.session, "--again", *names[:2])
        self.assertEqual(self.status()["images"], 5)
        self.assertIn("3 photographs of the session were taken in without", self.run_on(photos, "--masks", masks))
        self.assertEqual((self.status()["images"], self.status()["rejected"]), (7, 0))
        shutil.rmtree(self.session)
        self.run_on(photos, "--masks", masks, "--order", self.order(names[:5]))
        write_png(masks / f"{names[5]}.png", rows)
        self.run_on(photos)  # goes on with them
        self.assertNotIn("taken in without", self.run_on(photos, "--masks", masks))
        self.assertIn("no such folder", self.ends(BAD_INPUT, "run", photos, "--session", self.session, "--masks", "nowhere"))

    def test_photographs_are_taken_out_again(self):
        photos, names = self.wall()
        self.run_on(photos)
        self.assertEqual(self.status()["placed"], 7)
        remove = "remove", "--session", self.session
        self.assertIn("nobody.jpg is no image", self.ends(BAD_INPUT, *remove, "nobody.jpg"))
        self.assertIn("1 photograph removed; 1 cluster to be solved anew", self.ends(0, *remove, photos / names[3]))
        status = self.status()
        self.assertEqual((status["images"], status["placed"], status["rejected"]), (6, 6, 1))
        self.assertNotIn(names[3], self.names())
        removed = [image["words"] for image in status["image_list"] if image["name"] == names[3]]
        self.assertEqual(removed, ["was taken out with 'psfm remove', which '--undo' takes back"])
        export = "export", "--session", self.session, "--format", "colmap-database", "--output", self.folder / "database"
        self.assertIn("6 images of 1 camera", self.ends(0, *export))
        self.ends(0, "check", "--session", self.session)
        self.run_on(photos)
        (photos / names[3]).rename(photos / "renamed.jpg")
        self.assertIn("taken out with 'psfm remove'", self.run_on(photos))
        self.assertEqual(self.status()["images"], 6)
        self.ends(0, "resume", "--session", self.session)
        self.ends(0, *remove, "--undo", names[3])
        self.assertIn(f"{names[3]} is not kept out of the session: there is nothing to undo",
                      self.ends(BAD_INPUT, *remove, "--undo", names[3]))
        self.run_on(photos)
        self.ends(BAD_INPUT, *remove, "--undo", names[3])
        status = self.status()
        self.assertEqual((status["images"], status["placed"], status["rejected"]), (7, 7, 0))
        self.assertIn("renamed.jpg", self.names())
        self.ends(0, "check", "--session", self.session)
        said = self.ends(0, *remove, *[name for name in self.names() if name not in names[:2]])
        self.assertIn("0 of 2 images placed", said)
        self.assertIn("psfm: ", said.splitlines()[-1], "why nothing is placed")

    def test_an_edited_photograph_comes_in_after_its_former_self_was_removed(self):
        photos, names = self.wall()
        self.run_on(photos)
        edited = photos / names[2]
        edited.write_bytes(edited.read_bytes() + b"edited")
        self.ends(0, "remove", "--session", self.session, names[2])
        self.run_on(photos)
        self.assertEqual((self.status()["images"], self.status()["placed"]), (7, 7))
        self.assertEqual(self.names(), names)


@unittest.skipUnless(os.environ.get("PSFM_DATASETS"), "PSFM_DATASETS does not name the folder of photographs")
class Cases(Sessions):
    def setUp(self):
        super().setUp()
        self.datasets = Path(os.environ["PSFM_DATASETS"])
        self.cases = self.datasets / "cases"

    def test_second_card(self):
        self.run_on(self.cases / "second-card/cardA")
        said = self.run_on(self.cases / "second-card/cardB")
        self.assertIn("5 photographs have the names of others in the session", said)
        self.assertEqual(self.status()["images"], 11)

    def test_thumbnails_subfolder(self):
        said = self.run_on(self.cases / "thumbnails-subfolder")
        self.assertIn("small/kermit004.jpg (160x120 px) is a small copy of kermit004.jpg (640x480 px)", said)
        status = self.status()
        self.assertEqual((status["images"], status["placed"], status["rejected"]), (11, 11, 11))

    def test_order_bom(self):
        photos = self.datasets / "kermit/images"
        self.run_on(photos, "--order", self.cases / "order-bom/bom.txt", "--batch")
        self.assertGreater(self.status()["images"], 0)

    def test_jpeg_without_eoi(self):
        said = self.ends(BAD_INPUT, "run", self.cases / "jpeg-without-eoi", "--session", self.session)
        self.assertIn("note 0009.jpg: lacks the marker at its end", said)
        self.assertEqual((self.status()["images"], self.status()["rejected"]), (1, 0))

    def test_masks_in_subfolder(self):
        photos = self.cases / "masks-in-subfolder"
        said = self.ends(BAD_INPUT, "run", photos, "--session", self.session)
        self.assertIn("2 files in " + str(photos / "masks") + " look like masks", said)
        self.assertEqual(self.status()["images"], 2)
        shutil.rmtree(self.session)
        said = self.ends(BAD_INPUT, "run", photos, "--session", self.session, "--masks", photos / "masks")
        self.assertIn("MASKS WITHOUT A PHOTOGRAPH", said)
        self.assertIn("0001.jpg.png", said)
        self.assertEqual(self.status()["images"], 2)


if __name__ == "__main__":
    BUILD = Path(sys.argv.pop(1)).resolve()
    unittest.main()
