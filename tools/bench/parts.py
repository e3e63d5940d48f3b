# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The parts of the benchmark, by name, in the order of the page."""
from collections.abc import Callable
from dataclasses import dataclass

import kernels
import matching
import over_session
import peers
import real
import simulated
import thread_scaling


def no_plots(_result):
    return {}


@dataclass(frozen=True)
class Part:
    name: str
    title: str
    words: str         # for --list
    measure: Callable  # settings -> result, which JSON can hold
    section: Callable  # result -> Markdown
    plots: Callable = no_plots  # result -> {file name: SVG}
    also: tuple = ()   # other names


PARTS = (
    Part("peers", "Whole programs", "psfm and COLMAP on castle-P19, fountain-P11 and books, in turn: time, memory, "
         "accuracy", peers.measure, peers.section),
    Part("real", "Ordinary photographs", "beside COLMAP on Strecha's scenes, sceaux, kermit, lund and real/: placed, "
         "errors, time, memory", real.measure, real.section),
    Part("matching", "Descriptor matching", "pairs a second beside COLMAP's matcher, on the same descriptors",
         matching.measure, matching.section),
    Part("kernels", "Kernels", "the Google Benchmark programs of tests/bench", kernels.measure, kernels.section),
    Part("session", "Latency and memory over a session", "quad-streams (--scenes temple-341, castle-P19), one image "
         "after the other", over_session.measure_session, over_session.session_section, over_session.session_plots,
         ("latency", "memory")),
    Part("simulated", "A session of thousands", "10,000 simulated images (--images): the last tenth by the second",
         simulated.measure, simulated.section, simulated.plots),
    Part("first-model", "The first model", "images needed and seconds, Strecha's scenes", over_session.measure_first,
         over_session.first_section),
    Part("scaling", "Threads", "quad-streams (--scenes …) on 1, 2, 4, … threads, and what each node of the flow graph "
         "did", thread_scaling.measure, thread_scaling.section, thread_scaling.plots),
)


def part_of(name):
    return next((part for part in PARTS if name == part.name or name in part.also), None)
