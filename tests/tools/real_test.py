#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/bench/run real: centres are aligned by the majority, and what stands wrong is not counted as placed."""
import random
import sys
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parents[2] / "tools/bench"
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOOL), str(TOOL.parent / "experiments")]

import alignment  # noqa: E402
import bench_settings  # noqa: E402
import peers  # noqa: E402
import real  # noqa: E402
from folder import Folder  # noqa: E402


class Alignment(Folder):
    def centres(self, count=20):
        draw = random.Random(7)
        return {f"{i}.jpg": tuple(draw.gauss(0, 1) for _ in range(3)) for i in range(count)}

    def moved(self, centres):
        """Turned by a right angle about z, twice as large, shifted."""
        return {name: (10 - 2 * y, 2 * x, 5 + 2 * z) for name, (x, y, z) in centres.items()}

    def test_a_similarity_is_taken_out(self):
        centres = self.centres()
        found = alignment.compare(centres, self.moved(centres))
        self.assertEqual((found["common"], found["beyond"], found["far"]), (20, 0, []))
        self.assertLess(found["most"], 1e-9)

    def test_the_majority_decides_and_the_others_are_counted(self):
        centres = self.centres()
        reference = self.moved(centres)
        for i in range(8):
            x, y, z = reference[f"{i}.jpg"]
            reference[f"{i}.jpg"] = (x + 3, y - 4, z)
        found = alignment.compare(centres, reference)
        self.assertEqual(sorted(found["far"]), [f"{i}.jpg" for i in range(8)])
        self.assertAlmostEqual(found["most"], 5)
        self.assertAlmostEqual(found["mean"], 5 * 8 / 20)
        self.assertLess(found["median"], 1e-9)

    def test_three_say_nothing(self):
        centres = self.centres(3)
        self.assertIsNone(alignment.compare(centres, self.moved(centres)))
        self.assertIsNone(alignment.compare({}, self.moved(centres)))

    def test_a_mirror_image_is_not_taken_for_the_scene(self):
        centres = self.centres()
        mirrored = {name: (-x, y, z) for name, (x, y, z) in centres.items()}
        self.assertGreater(alignment.compare(centres, mirrored)["beyond"], 5)

    def test_centres_in_a_file(self):
        (self.folder / "centres.txt").write_text("# metres\na.jpg 1 2 3\nb.jpg 1e-3 0 -1 0.1\n")
        self.assertEqual(alignment.read_centres(self.folder / "centres.txt"),
                         {"a.jpg": (1, 2, 3), "b.jpg": (0.001, 0, -1)})


def real_round(largest, beyond, seconds):
    return {"largest": largest, "models": 1, "ate_mean": None, "processor_seconds": seconds, "seconds": seconds,
            "peak_mib": 100, "aligned": {"beyond": beyond, "median_of_extent": 0.5, "mean": 1.0}}


class Real(Folder):
    def section(self, ours, theirs):
        return real.section({"colmap": "3.8", "kept_colmap": False, "scenes": {"kitchen": {
            "images": 25, "reference": "COLMAP's model", "rounds": [{"psfm": ours, "colmap": theirs}]}}})

    def test_a_photograph_that_stands_wrong_does_not_count(self):
        shown = self.section(real_round(25, 2, 6.0), {**real_round(24, 0, 60.0), "aligned": None})
        self.assertIn("| kitchen | 25 | 25 | 23 | 1 | 24 | 24 | 1 | **fewer** |", shown)
        self.assertIn("fewer rightly placed than COLMAP in kitchen", shown)
        self.assertIn("| **geometric mean** |  |  | **0.100** |", shown)

    def test_no_fewer(self):
        shown = self.section(real_round(25, 1, 6.0), {**real_round(24, 0, 60.0), "aligned": None})
        self.assertIn("Nowhere has psfm fewer", shown)

    def test_every_scene_is_asked_without_an_option(self):
        self.assertEqual(len(real.SCENES), 12)
        for peer in real.SCENES.values():
            settings = bench_settings.Settings(None, Path("psfm"), None)
            command = peers.psfm_command(settings, peer, (Path("images"), ["a.jpg"], None), self.folder)
            self.assertEqual([word for word in map(str, command) if word.startswith("--")], ["--session", "--order"])


if __name__ == "__main__":
    unittest.main()
