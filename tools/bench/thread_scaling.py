# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The same session on 1, 2, 4, … threads: speed-up, efficiency, serial fraction, and what each node did."""
import os
import shutil

import scenes
from arithmetic import amdahl_fit, median, scaling_rows, thread_counts
from bench_settings import chosen, photographs_of, scratch, write_order
from console import Failed, answer_json, say
from node_times import node_table
from orders import read_order
from report import number, table
from sources import in_datasets
from svg_plot import Panel, Series, draw
from watched import watch

ABOUT = """\
`psfm run --threads N` in its default mode, from photographs to the finished session; the numbers of threads take turns.
The serial fraction of a row is Karp and Flatt's, (1/S - 1/N) / (1 - 1/N) of the speed-up S on N threads: where it grows
with N, something is fought over. Amdahl's fit is the one fraction that explains all rows best. A node is *busy* while
it runs at least once, *waiting* while it has input and does not run (no thread is free), *starved* while it has none;
*work* adds up what ran at once, and what an input waited is counted until its node begins with it.
"""

SCENES = {scenes.QUAD.name: (scenes.QUAD, "quad-streams/streams_order.txt"),
          scenes.TEMPLE.name: (scenes.TEMPLE, None), scenes.CASTLE.name: (scenes.CASTLE, None),
          scenes.FOUNTAIN.name: (scenes.FOUNTAIN, None)}


def machine_threads():
    return len(os.sched_getaffinity(0))


def _one(settings, scene, order, threads):
    photographs, names, _ = photographs_of(settings, scene)
    if order is not None:
        names = read_order(in_datasets(settings, order))[:settings.images]
    folder = scratch(settings, f"scaling/{scene.name}")
    session, log = folder / "session", folder / "log.jsonl"
    run = watch([settings.psfm, "run", photographs, "--session", session, "--log", log, "--threads", threads,
                 "--order", write_order(folder, names)], folder / "psfm.txt", log)
    status = answer_json([settings.psfm, "status", "--session", session, "--json"])
    shutil.rmtree(folder)
    nodes = run.of_event("nodes")
    if not nodes:
        raise Failed(f"the log of {settings.psfm} tells nothing of its nodes; build it anew (cmake --build --preset "
                     "release)")
    return {**run.in_short(), "images": len(names), "placed": status["placed"], "nodes": nodes[-1]}


def measure(settings, counts=None):
    """@param counts  numbers of threads; none given: 1, 2, 4, … up to the machine's"""
    counts = sorted({1, *(counts or thread_counts(machine_threads()))})
    known = SCENES if settings.scenes else {scenes.QUAD.name: SCENES[scenes.QUAD.name]}
    result = {}
    for scene, order in chosen(settings, known):
        runs = {threads: [] for threads in counts}
        for number_of_round in range(settings.repeats):
            for threads in counts:
                say(f"{scene.name}: {threads} thread{'s' if threads > 1 else ''}, round {number_of_round + 1} of "
                    f"{settings.repeats} …")
                runs[threads].append(_one(settings, scene, order, threads))
        result[scene.name] = {"runs": {str(threads): rounds for threads, rounds in runs.items()}}
    return result


def seconds_of(scene):
    return {int(threads): median([run["seconds"] for run in rounds]) for threads, rounds in scene["runs"].items()}


def section(result):
    parts = [ABOUT]
    for name, scene in result.items():
        times = seconds_of(scene)
        rows = []
        for threads, seconds, speed_up, efficiency, serial in scaling_rows(times):
            rounds = scene["runs"][str(threads)]
            work = median([run["processor_seconds"] for run in rounds])
            rows.append([str(threads), number(seconds, 1), number(work, 1), number(speed_up, 2), number(efficiency, 2),
                         number(serial, 3), number(median([run["placed"] for run in rounds]))])
        fit = amdahl_fit(times)
        images = scene["runs"]["1"][0]["images"]
        parts.append(f"\n### {name}, {images} images\n\n")
        if fit is not None:
            parts.append(f"Serial fraction by Amdahl's law, fitted to all rows: **{number(fit, 3)}**.\n\n")
        parts.append(table(["threads", "seconds", "processor time [s]", "speed-up", "efficiency", "serial fraction",
                            "placed"], rows))
        parts.append(f"\n![Speed-up over threads, {name}](performance/scaling-{name}.svg)\n")
        for threads in sorted(times):
            parts.append("\n" + node_table(scene["runs"][str(threads)][-1]["nodes"]))
    return "".join(parts)


def plots(result):
    made = {}
    for name, scene in result.items():
        rows = scaling_rows(seconds_of(scene))
        most = rows[-1][0]
        panel = Panel("speed-up", [
            Series("measured", [(threads, speed_up) for threads, _, speed_up, _, _ in rows], "#1f5fa8", kind="marks"),
            Series("as many times as threads", [(0, 0), (most, most)], "#8c959f", dash="2 4", width=1.5)], height=260)
        made[f"scaling-{name}.svg"] = draw(f"Speed-up over threads: {name}", "The same session on more threads.",
                                           "threads", most, [panel])
    return made
