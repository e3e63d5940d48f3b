# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Latency and memory while a session grows, and how soon its first model is there."""
import shutil

import scenes
from arithmetic import median, percentile, quotient, within
from bench_settings import chosen, photographs_of, scratch, thread_options, write_order
from console import Failed, answer_json, say
from node_times import node_table
from orders import read_order
from report import number, paragraph, significant, table
from sources import in_datasets
from svg_plot import Panel, Series, draw
from watched import watch

SESSION_ABOUT = """\
Latency is the time from an image's arrival to the published model that takes account of it (`latency_ms` in the log).
Each image arrives when the one before is published (`--deterministic`), so arrivals are no faster than processing.
Memory is the resident set, sampled five times a second, and its peak as the kernel counts it; the store's cache is part
of it. The last adjustment, when no image follows, belongs to the peak.
"""
FIRST_ABOUT = """\
Images that had to arrive until a model was published, and the seconds from the arrival of the last of them to that
model; photographs one after the other, in file-name order, nothing known of their cameras.
"""
WINDOWS = ((0, 100), (100, 200), (200, 300), (300, 400), (400, 500), (500, 600))
PSFM, MEMORY = "#1f5fa8", "#c8590b"

# Scenes and the orders in which their images arrive.
SESSIONS = {scenes.QUAD.name: (scenes.QUAD, "quad-streams/streams_order.txt"),
            scenes.TEMPLE.name: (scenes.TEMPLE, None), scenes.CASTLE.name: (scenes.CASTLE, None)}
STRECHA = {scene.name: scene for scene in (scenes.FOUNTAIN, scenes.HERZ_JESUS, scenes.ENTRY, scenes.CASTLE)}


def _one_session(settings, scene, order, name):
    """@return (watched.Watched, images, status, evaluation)"""
    photographs, names, reference = photographs_of(settings, scene)
    if order is not None:
        names = read_order(in_datasets(settings, order))[:settings.images]
    folder = scratch(settings, name)
    session, log = folder / "session", folder / "log.jsonl"
    run = watch([settings.psfm, "run", photographs, "--session", session, "--log", log, "--deterministic", "--order",
                 write_order(folder, names), *thread_options(settings)], folder / "psfm.txt", log)
    status = answer_json([settings.psfm, "status", "--session", session, "--json"])
    evaluation = answer_json([settings.psfm, "evaluate", "--reference", reference, "--session", session, "--json"],
                             accept=None) if reference else None
    shutil.rmtree(folder)
    return run, len(names), status, evaluation


def latencies(log):
    """(image, seconds), ascending."""
    return sorted((entry["index"], entry["latency_ms"] / 1000) for entry in log if entry["event"] == "image")


def thinned(samples, most=400):
    """The largest memory of neighbouring samples: a plot needs no more."""
    step = max(1, len(samples) // most)
    parts = [samples[i:i + step] for i in range(0, len(samples), step)]
    return [max(part, key=lambda sample: sample[2]) for part in parts]


def measure_session(settings):
    known = SESSIONS if settings.scenes else {scenes.QUAD.name: SESSIONS[scenes.QUAD.name]}
    result = {}
    for scene, order in chosen(settings, known):
        say(f"{scene.name}: one image after the other …")
        run, count, status, evaluation = _one_session(settings, scene, order, f"session/{scene.name}")
        model = ((evaluation or {}).get("models") or [{}])[0]
        result[scene.name] = {
            "images": count, "placed": status["placed"], "outliers": model.get("outliers"),
            "ate_rel": model.get("ate_rel"), **run.in_short(), "latency_s": latencies(run.log),
            "samples": thinned(run.samples), "nodes": (run.of_event("nodes") or [None])[-1]}
    return result


def _windows(points, last):
    rows = []
    for low, high in WINDOWS:
        values = within(points, low, high)
        if values and low < last:
            rows.append((low, min(high, last), median(values), percentile(values, 0.95)))
    return rows


def growth(points):
    """Median of images 500-600 by that of images 100-200; None for shorter sessions."""
    return quotient(median(within(points, 500, 600)), median(within(points, 100, 200)))


def session_section(result):
    parts = [SESSION_ABOUT]
    for name, scene in result.items():
        points = scene["latency_s"]
        memory = [(images, mib) for _, images, mib in scene["samples"]]
        rows = [[f"{low + 1}–{high}", number(middle, 2), number(high_part, 2),
                 number(max(within(memory, low, high), default=None))]
                for low, high, middle, high_part in _windows(points, scene["images"])]
        values = [seconds for _, seconds in points]
        rows.append(["all", number(median(values), 2), number(percentile(values, 0.95), 2), number(scene["peak_mib"])])
        parts.append(f"\n### {name}, {scene['images']} images\n\n")
        words = (f"{scene['placed']} placed, {number(scene['outliers'])} outliers, relative error "
                 f"{significant(scene['ate_rel'] and 100 * scene['ate_rel'], ' %')}; "
                 f"{number(scene['seconds'])} s in all, {number(scene['processor_seconds'])} s of processor time.")
        if growth(points) is not None:
            words += f" Median latency of images 501–600 / images 101–200: **{number(growth(points), 2)}**."
        parts.append(paragraph(words))
        parts.append("\n" + table(["images", "median latency [s]", "95th percentile [s]", "memory at most [MiB]"], rows))
        parts.append(f"\n![Latency and memory, {name}](performance/session-{name}.svg)\n")
        if scene["nodes"]:
            parts.append("\n" + node_table(scene["nodes"]))
    return "".join(parts)


def session_plots(result):
    made = {}
    for name, scene in result.items():
        latency = Panel("latency [ms]", [Series("psfm", [(i, 1000 * s) for i, s in scene["latency_s"]], PSFM,
                                                width=1.2)])
        memory = Panel("resident memory [MiB]", [Series("psfm", [(images, mib) for _, images, mib in scene["samples"]],
                                                        MEMORY)])
        made[f"session-{name}.svg"] = draw(f"Latency and memory over the session: {name}",
                                           f"{scene['images']} images, one after the other.", "images arrived",
                                           scene["images"], [latency, memory])
    return made


def first_model(log):
    """@return (images, seconds after the last of them), or None without a model"""
    for entry in log:
        if entry["event"] == "image" and entry["placed"] > 0:
            return entry["index"], entry["latency_ms"] / 1000
    return None


def measure_first(settings):
    result = {}
    for scene in chosen(settings, STRECHA):
        rounds = []
        for _ in range(settings.repeats):
            say(f"{scene.name}: until the first model …")
            run, count, _, _ = _one_session(settings, scene, None, f"first-model/{scene.name}")
            found = first_model(run.log)
            if found is None:
                raise Failed(f"{scene.name}: no model of {count} images")
            rounds.append(found)
        result[scene.name] = {"images": [images for images, _ in rounds], "seconds": [after for _, after in rounds]}
    return result


def first_section(result):
    rows = [[name, number(median(scene["images"])), number(median(scene["seconds"]), 2)]
            for name, scene in result.items()]
    return FIRST_ABOUT + "\n" + table(["scene", "images needed", "seconds after the last of them"], rows)
