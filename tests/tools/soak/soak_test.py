#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/bench/soak: photographs come as planned, and growth is seen where there is some. Nothing here tests time."""
import os
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parents[3] / "tools/bench"
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOOL), str(TOOL.parent / "experiments")]

import soak_samples  # noqa: E402
import soak_stream  # noqa: E402
from soak_samples import Sample  # noqa: E402


class MadeUpPlaces:
    """Files of a few bytes in place of photographs."""

    def __init__(self, folder):
        self.folder, self.made = folder, 0

    def next(self):
        self.made += 1
        file = self.folder / f"made-{self.made}"
        file.write_text(f"photograph {self.made}")
        return file


class Streams(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name) / "incoming"
        self.folder.mkdir()
        self.stream = soak_stream.Stream(self.folder, MadeUpPlaces(Path(folder.name)), 2.0, 1)

    def test_a_cycle_has_a_trickle_a_burst_and_pauses(self):
        cycle = soak_stream.CYCLE_SECONDS
        wanted = [self.stream.wanted(part * cycle) for part in (0, 0.2, 0.4, 0.59, 0.6, 0.99, 1)]
        self.assertEqual(wanted, [0, 16, 32, 32, 80, 80, 80])

    def test_bad_ones_are_among_them_and_nothing_half_written(self):
        for second in range(200):
            self.stream.step(float(second))
            for name in list(self.stream.open):
                self.stream.answered(name)
        kinds = list(self.stream.sent.values())
        for kind in ("good", "damaged", "copy", "vanishing"):
            self.assertIn(kind, kinds)
        self.stream.close()
        left = os.listdir(self.folder)
        self.assertFalse([name for name in left if name.startswith(".")])
        self.assertEqual(len(left) + self.stream.deleted, len(kinds))

    def test_nobody_goes_on_when_nothing_is_answered(self):
        for second in range(1000):
            self.stream.step(float(second))
        self.assertLessEqual(self.stream.most_open, soak_stream.OPEN_LIMIT)
        self.assertGreater(self.stream.held_back, 0)


def samples_of(memory, others):
    """One a second; the first without an image."""
    return [Sample(float(second), second, memory(second), 0.0, 5, others(second), 1.0, 0) for second in range(91)]


class Judgement(unittest.TestCase):
    def judge(self, memory, others, minutes=30):
        return soak_samples.judge(soak_samples.thirds(samples_of(memory, others)), minutes)

    def test_what_is_flat_is_fine(self):
        # What is open for a moment, and what grows in the first third, is no growth.
        self.assertEqual(self.judge(lambda at: 100.0 + min(at, 30), lambda at: 10 + at % 3), [])

    def test_growing_memory_is_seen(self):
        self.assertEqual(len(self.judge(lambda at: 100.0 + at, lambda _: 10)), 1)
        self.assertEqual(self.judge(lambda at: 100.0 + at, lambda _: 10, minutes=1), [])

    def test_a_descriptor_that_stays_open_is_seen(self):
        self.assertEqual(len(self.judge(lambda _: 100.0, lambda at: 10 + at // 61)), 1)
        self.assertEqual(len(self.judge(lambda _: 100.0, lambda at: 10 + at, minutes=1)), 1)

    def test_no_image_is_no_judgement(self):
        self.assertEqual(soak_samples.judge(soak_samples.thirds(samples_of(lambda _: 1.0, lambda _: 1)[:1]), 30), [])


if __name__ == "__main__":
    unittest.main()
