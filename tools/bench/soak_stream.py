# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photographs that people copy into a watched folder, in bursts and with pauses, bad ones among them."""
import os
import random
import shutil
from collections import deque
from pathlib import Path

from console import answer

CYCLE_SECONDS = 40.0         # one by one, then a burst, then nothing
TRICKLE, BURST = 0.4, 0.6    # when each begins, as part of a cycle: 0 … 0.4 one by one, 0.4 … 0.6 nothing, then a burst
TRICKLE_PART = 0.4           # of a cycle's photographs that come one by one
PLACES_AT_ONCE = 3           # people who photograph different places at the same time
TEXELS = 300                 # a metre, for photographs of 1024 pixels' width
AT_ONCE = 20                 # photographs copied before anything else is looked after again
OPEN_LIMIT = 200             # unanswered photographs that nobody adds more to: the disk of the watched folder
KEPT = 0.25                  # part of the source files that nobody deletes
# Every so many photographs, in place of a good one
DAMAGED_EVERY, COPY_EVERY, VANISHING_EVERY = 40, 50, 60


class Places:
    """Walls that have nothing in common, photographed one after the other, several at once."""

    def __init__(self, render, folder, seed, images, width):
        self.render, self.folder, self.seed = render, folder, seed
        self.images, self.width = images, width
        self.waiting = [deque() for _ in range(PLACES_AT_ONCE)]
        self.made = self.turn = 0

    def _render(self, place, number):
        answer([self.render, place, "--scene", "wall", "--images", self.images, "--width", self.width,
                "--height", self.width * 3 // 4, "--texels-per-metre", max(20, self.width * TEXELS // 1024),
                "--seed", self.seed * 100_000 + number])

    def others(self, places):
        """A folder with photographs of places that next() does not have."""
        folder = self.folder.with_name("others")
        for number in range(places):
            self._render(folder / str(number), 90_000 + number)
        return folder

    def next(self):
        """A file that is the caller's from now on."""
        self.turn = (self.turn + 1) % PLACES_AT_ONCE
        photographs = self.waiting[self.turn]
        if not photographs:
            self.made += 1
            place = self.folder / f"place-{self.made:05}"
            self._render(place, self.made)
            photographs.extend(sorted((place / "images").iterdir()))
        photograph = photographs.popleft()
        if not photographs:  # the last one of the place
            moved = self.folder / f"last-of-{photograph.parent.parent.name}.jpg"
            photograph.rename(moved)
            shutil.rmtree(photograph.parent.parent)
            return moved
        return photograph


class Stream:
    """What is copied into the folder when, and what is deleted from it again.

    @param places  photographs: next() gives the next file
    @param rate    photographs a second, over a whole cycle
    """

    def __init__(self, folder, places, rate, seed):
        self.folder, self.places, self.rate = folder, places, rate
        self.random = random.Random(seed)
        self.sent = {}        # name: what it is; good, damaged, copy or vanishing
        self.open = set()     # names without an answer
        self.deleted = 0
        self.most_open = self.held_back = 0
        self._vanishing = []  # (when, name)
        self._latest = None   # the bytes of a good photograph

    def wanted(self, seconds):
        """How many photographs there should have been so many seconds after the start."""
        cycles, part = divmod(seconds / CYCLE_SECONDS, 1.0)
        one_by_one = TRICKLE_PART * min(part / TRICKLE, 1.0)
        burst = 1.0 - TRICKLE_PART if part >= BURST else 0.0
        return int((cycles + one_by_one + burst) * self.rate * CYCLE_SECONDS)

    def step(self, seconds):
        """Copies what is due, and deletes what is to vanish before anybody may have looked at it."""
        due = self.wanted(seconds) - len(self.sent) - self.held_back
        for _ in range(min(due, AT_ONCE)):
            if len(self.open) >= OPEN_LIMIT:
                self.held_back += 1
                continue
            self._send(seconds)
        self.most_open = max(self.most_open, len(self.open))
        for when, name in [entry for entry in self._vanishing if entry[0] <= seconds]:
            self._vanishing.remove((when, name))
            self._delete(name)
            self.open.discard(name)  # there may be an answer, or none

    def _send(self, seconds):
        number = len(self.sent) + 1
        name = f"{number:06}.jpg"
        kind = "good"
        if number % DAMAGED_EVERY == 0:
            kind, data = "damaged", self.random.randbytes(3000)
        elif number % COPY_EVERY == 0 and self._latest:
            kind, data = "copy", self._latest
        else:
            file = self.places.next()
            data = file.read_bytes()
            file.unlink()
            if number % VANISHING_EVERY == 0:
                kind = "vanishing"
                self._vanishing.append((seconds + self.random.uniform(0.0, 3.0), name))
            else:
                self._latest = data
        part = self.folder / f".{name}.part"
        part.write_bytes(data)
        when = self.random.uniform(0, 4e9)  # cameras have their own idea of the time: 1970 to 2096
        os.utime(part, (when, when))
        part.rename(self.folder / name)
        self.sent[name] = kind
        self.open.add(name)

    def answered(self, name):
        """Most files are deleted once psfm has said that it has them."""
        self.open.discard(name)
        if self.random.random() >= KEPT:
            self._delete(name)

    def _delete(self, name):
        file = self.folder / name
        if file.exists():
            file.unlink()
            self.deleted += 1

    def close(self):
        """Nobody waits for what was to vanish."""
        for _, name in self._vanishing:
            self._delete(name)
            self.open.discard(name)
        self._vanishing.clear()


class Clock:
    """The wall clock of one process: tests/tools/soak/shift_clock.cpp."""

    JUMPS = (3600, -3600, 86400 * 365, -86400 * 365 * 2, 86400 * 30, 0)  # ahead or behind the true time [s]

    def __init__(self, file, library):
        self.file, self.changes = Path(file), 0
        self.file.write_bytes((0).to_bytes(8, "little", signed=True))
        self.environment = {"LD_PRELOAD": str(library), "PSFM_CLOCK_SHIFT": str(self.file)}

    def jump(self):
        """To the next of the times, in turn."""
        with self.file.open("r+b") as stream:
            stream.write(self.JUMPS[self.changes % len(self.JUMPS)].to_bytes(8, "little", signed=True))
        self.changes += 1
