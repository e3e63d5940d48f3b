# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Orders in which images arrive, and the sizes at which programs are compared."""
import math
import os
from pathlib import Path
from random import Random

_N, _M = 312, 156
_MASK = (1 << 64) - 1


class Mt19937_64:
    """The 64-bit Mersenne twister of C++'s <random> (Matsumoto & Nishimura, TOMACS 2000)."""

    def __init__(self, seed):
        self._state = [seed & _MASK]
        for i in range(1, _N):
            last = self._state[-1]
            self._state.append((6364136223846793005 * (last ^ (last >> 62)) + i) & _MASK)
        self._next = _N

    def _twist(self):
        state = self._state
        for i in range(_N):
            bits = (state[i] & ~0x7FFFFFFF) | (state[(i + 1) % _N] & 0x7FFFFFFF)
            state[i] = state[(i + _M) % _N] ^ (bits >> 1) ^ (0xB5026F5AA96619E9 if bits & 1 else 0)
        self._next = 0

    def __call__(self):
        if self._next == _N:
            self._twist()
        value = self._state[self._next]
        self._next += 1
        value ^= (value >> 29) & 0x5555555555555555
        value ^= (value << 17) & 0x71D67FFFEDA60000
        value ^= (value << 37) & 0xFFF7EEE000000000
        return value ^ (value >> 43)


def sorted_names(names):
    """Bytewise, as psfm sorts."""
    return sorted(names, key=os.fsencode)


def shuffled_names(names, seed):
    """The order of `psfm run --shuffle SEED`, written down so that COLMAP can follow it."""
    names = sorted_names(names)
    random = Mt19937_64(seed)
    for i in range(len(names) - 1, 0, -1):
        j = random() % (i + 1)
        names[i], names[j] = names[j], names[i]
    return names


def sampled_names(names, count, seed):
    """Some of the names, drawn by Python's own generator."""
    return sorted_names(Random(f"{seed}{count}").sample(sorted_names(names), count))


def read_order(file):
    lines = Path(file).read_text(errors="surrogateescape").split("\n")
    return [line.rstrip("\r") for line in lines if line.rstrip("\r")]


def write_order(file, names):
    Path(file).write_text("".join(name + "\n" for name in names), errors="surrogateescape")


def step_plan(count):
    """After how many images COLMAP is continued: for the temple's 341, 20 40 60 80 114 171 228 341."""
    if count <= 60:
        steps = [math.ceil(count * part / 4) for part in (1, 2, 3)]
    else:
        steps = [20, 40, 60, 80] + [math.ceil(count / 3), math.ceil(count / 2), math.ceil(2 * count / 3)]
    return sorted({step for step in steps if 2 <= step < count} | {count})
