# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Matching the same descriptors: pairs a second of psfm and of COLMAP's matcher for the processor, one thread each."""
import json
import shutil
import sqlite3

import scenes
from arithmetic import median
from bench_settings import photographs_of, scratch, write_order
from colmap_progressive import colmap_version
from console import Failed, answer, say
from peers import required_colmap
from report import number, table
from watched import watch

ABOUT = """\
COLMAP extracts features from sceaux's first four photographs, of which the first 8,000 of each image are kept; both
programs match all six pairs, on one thread, in turn. COLMAP's matcher also verifies: it is run once more with matches
and without verified pairs, and what that takes is subtracted. psfm's time has the packing of descriptors in it, and
comes from `match_database`. Processor time, medians.
"""
IMAGES, FEATURES = 4, 8000


def _colmap_seconds(database, folder, what):
    command = ["colmap", "exhaustive_matcher", "--database_path", database, "--SiftMatching.use_gpu", 0,
               "--SiftMatching.num_threads", 1]
    return watch(command, folder / f"{what}.txt").processor_seconds


def _forget(database, *tables):
    connection = sqlite3.connect(database)
    with connection:
        for name in tables:
            connection.execute(f"DELETE FROM {name}")
    connection.close()


def keep_features(database, count):
    """Leaves so many of each image, at most."""
    connection = sqlite3.connect(database)
    with connection:
        for table_name, row_bytes in (("keypoints", "4 * cols"), ("descriptors", "cols")):
            connection.execute(f"UPDATE {table_name} SET data = substr(data, 1, ? * {row_bytes}), rows = ? "
                               "WHERE rows > ?", (count, count, count))
    connection.close()


def measure(settings):
    required_colmap()
    program = settings.psfm.parent / "tests/bench/match_database"
    if not program.is_file():
        raise Failed(f"{program} is not there; it is built where Google Benchmark is (apt-get install libbenchmark-dev)")
    photographs, names, _ = photographs_of(settings, scenes.SCEAUX)
    folder = scratch(settings, "matching")
    database = folder / "database.db"
    watch(["colmap", "feature_extractor", "--database_path", database, "--image_path", photographs,
           "--image_list_path", write_order(folder, names[:IMAGES]), "--SiftExtraction.use_gpu", 0,
           "--SiftExtraction.max_num_features", FEATURES], folder / "extract.txt")
    keep_features(database, FEATURES)  # COLMAP's limit is a rough one
    rounds = []
    for number_of_round in range(settings.repeats):
        say(f"matching: round {number_of_round + 1} of {settings.repeats} …")
        whole = _colmap_seconds(database, folder, "match")
        _forget(database, "two_view_geometries")
        verified = _colmap_seconds(database, folder, "verify")
        ours = json.loads(answer([program, database]))
        _forget(database, "two_view_geometries", "matches")
        rounds.append({"pairs": ours["pairs"], "features": ours["features"], "psfm_s": ours["seconds"],
                       "colmap_s": whole - verified, "colmap_verification_s": verified})
    shutil.rmtree(folder)
    return {"colmap": colmap_version(), "rounds": rounds}


def section(result):
    rounds = result["rounds"]

    def pairs_a_second(key):
        return median([one["pairs"] / one[key] for one in rounds])

    ratio = median([one["colmap_s"] / one["psfm_s"] for one in rounds])
    features = rounds[0]["features"]
    rows = [["psfm", number(pairs_a_second("psfm_s"), 1), number(ratio, 1)],
            [f"COLMAP {result['colmap']}", number(pairs_a_second("colmap_s"), 2), "1"]]
    return (ABOUT + f"\n{min(features):,} features or more; rounds: {len(rounds)}.\n\n"
            + table(["program", "pairs a second", "times COLMAP's"], rows))
