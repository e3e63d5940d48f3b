# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The report of record on ordinary photographs: psfm with no option given, beside COLMAP, in turn."""
import shutil

import scenes
from alignment import compare, read_centres
from bench_settings import chosen, photographs_of, scratch, thread_options
from colmap_model import centres_of, models_in
from colmap_progressive import judge
from console import say
from kept import Kept, digest_of_names
from peers import Peer, colmap_commands, psfm_command, required_colmap, result_of, watch_steps
from real_report import section  # noqa: F401  (the part's own)
from sources import in_datasets
from watched import Watched, watch

SCENES = {source.name: Peer(source, "unsaid") for source in (
    scenes.KITCHEN, scenes.BANANA, scenes.BRIGHTON, scenes.IONIQ5, scenes.MULTICAM, scenes.FOUNTAIN,
    scenes.HERZ_JESUS, scenes.ENTRY, scenes.CASTLE, scenes.SCEAUX, scenes.KERMIT, scenes.LUND)}
CENTRES = {scenes.BRIGHTON.name: "real/brighton/centres.txt", scenes.MULTICAM.name: "real/multicam/centres.txt"}


def _run_psfm(settings, peer, given):
    """@return its figures; the models that it ends with stay in the folder"""
    folder = scratch(settings, f"real/{peer.name}-psfm")
    run = watch(psfm_command(settings, peer, given, folder), folder / "psfm.txt")
    exported = folder / "exported"
    watch([settings.psfm, "export", "--session", folder / "session", "--format", "colmap", "--output", exported],
          folder / "export.txt")
    models = models_in(exported) if exported.is_dir() else []
    return result_of({"run": run}, judge(settings, models, given[2])), models


def _run_colmap(settings, peer, given, version):
    """As _run_psfm. What it made is kept until the next time, for --kept-colmap."""
    photographs, names, _ = given
    sizes = [f"{name} {(photographs / name).stat().st_size}" for name in names]
    kept = Kept(settings.work / f"real-colmap/{peer.name}", {
        "colmap": version, "photographs": digest_of_names(sizes), "threads": settings.threads})
    record = kept.record() if settings.kept_colmap else None
    if record is None:
        kept.begin()
        commands, sparse = colmap_commands(settings, peer, given, kept.folder)
        steps = watch_steps(commands, kept.folder)
        (kept.folder / "database.db").unlink()
        record = kept.finish({name: run.in_short() for name, run in steps.items()})
    steps = {name: Watched(**run) for name, run in record.items()}
    models = models_in(kept.folder / "sparse")
    return result_of(steps, judge(settings, models, given[2])), models


def _reference(settings, peer, given, colmap_models):
    """What centres are compared with: (words, {name: centre}). COLMAP's model only where nothing better is known."""
    if given[2] is not None:
        return "gt", centres_of(given[2])
    if peer.name in CENTRES:
        return "centres.txt", read_centres(in_datasets(settings, CENTRES[peer.name]))
    return "COLMAP's model", centres_of(colmap_models[0]) if colmap_models else {}


def _round(settings, peer, given, version):
    psfm, models = _run_psfm(settings, peer, given)
    colmap, colmap_models = _run_colmap(settings, peer, given, version)
    words, reference = _reference(settings, peer, given, colmap_models)
    psfm["aligned"] = compare(centres_of(models[0]), reference) if models else None
    itself = words == "COLMAP's model"
    colmap["aligned"] = compare(centres_of(colmap_models[0]), reference) if colmap_models and not itself else None
    shutil.rmtree(settings.work / f"real/{peer.name}-psfm")
    return {"psfm": psfm, "colmap": colmap}, words


def measure(settings):
    version = required_colmap()
    result = {"colmap": version, "kept_colmap": settings.kept_colmap, "scenes": {}}
    for peer in chosen(settings, SCENES):
        given = photographs_of(settings, peer.source)
        rounds = []
        for number_of_round in range(settings.repeats):
            say(f"{peer.name}: {len(given[1])} photographs, round {number_of_round + 1} of {settings.repeats} …")
            one, words = _round(settings, peer, given, version)
            rounds.append(one)
        result["scenes"][peer.name] = {"images": len(given[1]), "reference": words, "rounds": rounds}
    return result
