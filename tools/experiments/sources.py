# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""From a run's description to files: photographs or a database of matches, the reference, the order."""
import sqlite3
from dataclasses import dataclass
from pathlib import Path

import orders
from console import Failed, call, say
from kept import Kept, digest_of_file, digest_of_names
from scenes import Simulation

SUFFIXES = {".jpg", ".jpeg", ".png", ".tif", ".tiff", ".heic", ".bmp", ".webp"}


@dataclass(frozen=True)
class Settings:
    """What the command line asks for."""
    datasets: Path | None
    psfm: Path
    work: Path
    output: Path
    images: int | None = None
    database: Path | None = None
    share_matches: bool = False
    colmap: bool = True
    colmap_until: int | None = None  # images after which COLMAP is not continued
    again: bool = False
    # Of the tables of orders and, scenes only, of subsets: names; none: all of them.
    scenes: tuple = ()
    orders: tuple = ()
    modes: tuple = ()

    def parts(self):
        return {"scenes": self.scenes, "orders": self.orders, "modes": self.modes}


@dataclass(frozen=True)
class Input:
    """What both programs are given."""
    names: list            # in order of arrival
    photographs: Path | None
    database: Path | None  # None: psfm finds the matches itself
    reference: Path | None
    identity: str          # of the pixels or matches, to know whether kept work is still about them


def database_names(file):
    try:
        connection = sqlite3.connect(f"{Path(file).resolve().as_uri()}?mode=ro&immutable=1", uri=True)
        try:
            return [name for (name,) in connection.execute("SELECT name FROM images")]
        finally:
            connection.close()
    except sqlite3.Error as error:
        raise Failed(f"{file} is no COLMAP database ({error}); `psfm export --format colmap-database` "
                     "writes one") from error


def in_datasets(settings, path):
    if settings.datasets is None:
        raise Failed("where the photographs are is not known; set PSFM_DATASETS or give --datasets DIR")
    found = settings.datasets / path
    if not found.exists():
        raise Failed(f"{found} is missing; --datasets (or PSFM_DATASETS) names the folder that docs/datasets.md describes")
    return found


def photograph_names(folder):
    names = [file.relative_to(folder).as_posix() for file in folder.rglob("*")
             if file.suffix.lower() in SUFFIXES and file.is_file()]
    if not names:
        raise Failed(f"{folder} holds no photographs; --datasets names the folder that docs/datasets.md describes")
    return orders.sorted_names(names)


def simulate(settings, simulation):
    """The simulation's folder, made once."""
    kept = Kept(settings.work / "simulated-scenes" / simulation.name, {"options": simulation.options})
    if kept.record() is None:
        say(f"simulating {simulation.name} …")
        kept.begin()
        call([settings.psfm, "simulate", "--output", kept.folder, *simulation.options],
             kept.folder / "simulate.log")
        kept.finish({})
    return kept.folder


def _ordered(names, order, order_file):
    kind = order[0]
    if kind == "shuffle":
        return orders.shuffled_names(names, order[1])
    if kind == "names":
        return orders.sorted_names(names)
    if kind == "sample":
        _, count, seed = order
        if count > len(names):
            raise Failed(f"{count} photographs are to be drawn of {len(names)}; is the data set whole?")
        return orders.sampled_names(names, count, seed)
    ordered = orders.read_order(order_file(order[1]))
    missing = sorted(set(ordered) - set(names))
    if missing:
        raise Failed(f"{order[1]} names {missing[0]}, which is not among the images; are folder and order of one kind?")
    return ordered


def resolve(settings, run, database=None):
    """@param database  matches to take instead of the run's own photographs"""
    if isinstance(run.source, Simulation):
        folder = simulate(settings, run.source)
        database = folder / "database.db"
        photographs, reference = None, folder / "reference"
        order_file = folder.joinpath
    else:
        photographs = in_datasets(settings, run.source.images)
        reference = in_datasets(settings, run.source.reference) if run.source.reference else None

        def order_file(path):
            return in_datasets(settings, path)
    if database is not None:
        names = database_names(database)
        identity = "matches " + digest_of_file(database)
        if photographs is not None and not set(names) & set(photograph_names(photographs)):
            raise Failed(f"{database} knows none of the photographs in {photographs}; give the database of "
                         f"{run.source.name}, or none")
    else:
        names = photograph_names(photographs)
        # Names and sizes tell folders apart well enough, and gigabytes of photographs need not be read.
        sizes = [f"{name} {(photographs / name).stat().st_size}" for name in names]
        identity = "photographs " + digest_of_names(sizes)
    ordered = _ordered(names, run.order, order_file)
    return Input(ordered[:settings.images], photographs, database, reference, identity)

