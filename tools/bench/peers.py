# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Whole programs: psfm while the images arrive, beside COLMAP in one go, on the same photographs, in turn."""
import shutil
from dataclasses import dataclass

import scenes
from arithmetic import median, quotient
from bench_settings import chosen, photographs_of, scratch, thread_options, write_order
from colmap_model import models_in
from colmap_progressive import colmap_version, judge
from console import Failed, answer_json, say
from report import number, significant, table
from watched import watch

ABOUT = """\
From photographs to the finished model. psfm is run as its users run it (each image is extracted, matched, clustered,
solved and published as it comes, several in flight), and once more taking every image through the whole graph before
the next one (`--deterministic`). COLMAP sees all photographs at once: feature_extractor, exhaustive_matcher and mapper,
on the processor, its defaults otherwise. Both have the same intrinsics: given and fixed, or one camera for all
photographs, of which nothing is known. Programs take turns; a ratio is the median over the rounds' own ratios.
"""


@dataclass(frozen=True)
class Peer:
    """A scene and what is known of its cameras: "given" (in the reference), "shared" by all photographs, or
    "unsaid": psfm decides by itself, COLMAP takes one camera."""
    source: scenes.Photographs
    intrinsics: str

    @property
    def name(self):
        return self.source.name


SCENES = {peer.name: peer for peer in (Peer(scenes.CASTLE, "given"), Peer(scenes.FOUNTAIN, "given"),
                                       Peer(scenes.BOOKS, "shared"))}


def given_pinhole(reference):
    """The parameters that all cameras of a COLMAP text model share: COLMAP takes those of one camera only."""
    found = set()
    for line in (reference / "cameras.txt").read_text().splitlines():
        words = line.split()
        if words and not line.startswith("#"):
            found.add((words[1], ",".join(words[4:])))
    if len(found) != 1 or next(iter(found))[0] != "PINHOLE":
        raise Failed(f"{reference}/cameras.txt: COLMAP wants one PINHOLE camera for all photographs")
    return next(iter(found))[1]


NO_MODEL = "failed to create sparse model"  # COLMAP's mapper has placed nothing, and ends with status 1


def watch_steps(commands, folder):
    """{step: Watched} of COLMAP's commands, one after the other."""
    return {name: watch(command, folder / f"{name}.txt", accept=NO_MODEL) for name, command in commands.items()}


def colmap_commands(settings, peer, given, folder):
    """@return ({step: command}, folder that the mapper writes into)"""
    photographs, names, reference = given
    database, sparse = folder / "database.db", folder / "sparse"
    sparse.mkdir()
    camera, fixed = [], []
    if peer.intrinsics == "given":
        camera = ["--ImageReader.camera_model", "PINHOLE", "--ImageReader.camera_params", given_pinhole(reference)]
        fixed = [word for name in ("focal_length", "principal_point", "extra_params")
                 for word in (f"--Mapper.ba_refine_{name}", 0)]
    return {
        "extract": ["colmap", "feature_extractor", "--database_path", database, "--image_path", photographs,
                    "--image_list_path", write_order(folder, names), "--ImageReader.single_camera", 1, *camera,
                    "--SiftExtraction.use_gpu", 0, *thread_options(settings, "--SiftExtraction.num_threads")],
        "match": ["colmap", "exhaustive_matcher", "--database_path", database, "--SiftMatching.use_gpu", 0,
                  *thread_options(settings, "--SiftMatching.num_threads")],
        "map": ["colmap", "mapper", "--database_path", database, "--image_path", photographs, "--output_path", sparse,
                *fixed, *thread_options(settings, "--Mapper.num_threads")],
    }, sparse


def result_of(steps, judged):
    """@param steps  {name: watched.Watched}"""
    runs = list(steps.values())
    return {"seconds": sum(run.seconds for run in runs),
            "processor_seconds": sum(run.processor_seconds for run in runs),
            "peak_mib": max(run.peak_mib for run in runs),
            "steps": {name: round(run.seconds, 2) for name, run in steps.items()}, **judged}


def _run_colmap(settings, peer, given):
    folder = scratch(settings, f"peers/{peer.name}-colmap")
    commands, sparse = colmap_commands(settings, peer, given, folder)
    steps = watch_steps(commands, folder)
    judged = judge(settings, models_in(sparse), given[2])
    shutil.rmtree(folder)
    return result_of(steps, judged)


def psfm_command(settings, peer, given, folder, mode=()):
    photographs, names, reference = given
    cameras = {"given": ["--cameras", reference, "--fix-intrinsics"], "shared": ["--camera-sharing", "all"],
               "unsaid": []}[peer.intrinsics]
    return [settings.psfm, "run", photographs, "--session", folder / "session", "--order", write_order(folder, names),
            *cameras, *mode, *thread_options(settings)]


def _run_psfm(settings, peer, given, mode):
    reference = given[2]
    folder = scratch(settings, f"peers/{peer.name}-psfm")
    run = watch(psfm_command(settings, peer, given, folder, mode), folder / "psfm.txt")
    status = answer_json([settings.psfm, "status", "--session", folder / "session", "--json"])
    evaluation = answer_json([settings.psfm, "evaluate", "--reference", reference, "--session", folder / "session",
                              "--json"], accept=None) if reference else None
    shutil.rmtree(folder)
    model = ((evaluation or {}).get("models") or [{}])[0]
    return result_of({"run": run}, {"placed": status["placed"], "largest": model.get("registered"),
                                    "outliers": model.get("outliers"), "ate_mean": model.get("ate_mean")})


def _round(settings, peer, given):
    return {"psfm": _run_psfm(settings, peer, given, []),
            "colmap": _run_colmap(settings, peer, given),
            "psfm, one by one": _run_psfm(settings, peer, given, ["--deterministic"])}


def required_colmap():
    """@return its version"""
    version = colmap_version()
    if version is None:
        raise Failed("COLMAP is not installed (apt-get install colmap), so there is nothing to compare with")
    return version


def measure(settings):
    result = {"colmap": required_colmap(), "scenes": {}}
    for peer in chosen(settings, SCENES):
        given = photographs_of(settings, peer.source)
        rounds = []
        for number_of_round in range(settings.repeats):
            say(f"{peer.name}: round {number_of_round + 1} of {settings.repeats} …")
            rounds.append(_round(settings, peer, given))
        result["scenes"][peer.name] = {"images": len(given[1]), "intrinsics": peer.intrinsics, "rounds": rounds}
    return result


def ratio(rounds, program, key):
    return median([quotient(one[program][key], one["colmap"][key]) for one in rounds])


def _row(scene, name, program, words):
    rounds = scene["rounds"]

    def middle(key):
        values = [one[program][key] for one in rounds if one[program][key] is not None]
        return median(values)

    ratios = ["", ""] if program == "colmap" else [number(ratio(rounds, program, "seconds"), 3),
                                                   number(ratio(rounds, program, "processor_seconds"), 3)]
    steps = rounds[0][program]["steps"]
    detail = (", ".join(f"{step} {number(median([one[program]['steps'][step] for one in rounds]), 1)}"
                        for step in steps) if len(steps) > 1 else "")
    return [name, words, detail, number(middle("seconds"), 1), *ratios, number(middle("placed")),
            significant(middle("ate_mean")), number(middle("outliers")), number(middle("peak_mib"))]


def section(result):
    rows = []
    for name, scene in result["scenes"].items():
        words = f"{name}, {scene['images']} images, intrinsics {scene['intrinsics']}"
        for program in ("psfm", "psfm, one by one", "colmap"):
            rows.append(_row(scene, words, program, f"COLMAP {result['colmap']}" if program == "colmap" else program))
    head = ["scene", "program", "steps [s]", "whole [s]", "ratio", "ratio of processor time", "placed", "mean error",
            "outliers", "peak [MiB]"]
    rounds = max((len(scene["rounds"]) for scene in result["scenes"].values()), default=0)
    return f"{ABOUT}Medians of {rounds} round{'s' if rounds != 1 else ''}.\n\n" + table(head, rows, words=3)
