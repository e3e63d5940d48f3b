# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The promise as a table: how every scene ends in every order and mode, and how right it was on the way."""
from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import psfm_session
import scenes
from colmap_progressive import run_colmap
from console import Failed, say
from experiment import RunResult, matches_for, measured
from sources import resolve

# How psfm is run. The street has ended differently from one run to the next, and with one camera for all of it.
MODES = {"deterministic": ("--deterministic",), "default": (), "default-2": (), "default-3": (),
         "one-camera": ("--deterministic", "--camera-sharing", "all"), "one-camera-default": ("--camera-sharing", "all")}
OF_ALL = ("deterministic", "default")
LEAST = 5  # images of a part; of fewer it is not said whether they are right
WAYS = tuple(f"shuffle-{seed}" for seed in range(1, 6))  # orders whose way is shown


@dataclass(eq=False)
class Cell:
    """A session at its end. Without a result it failed, and was said to."""
    scene: str
    order: str
    mode: str
    result: RunResult | None = None

    @cached_property
    def parts(self):
        """Sizes, largest first."""
        return sorted(self._sizes.values(), reverse=True)

    @cached_property
    def _sizes(self):
        sizes = Counter(image["part"] for image in self._placed)
        return {part: size for part, size in sizes.items() if size >= LEAST}

    @property
    def _placed(self):
        return [image for image in self.result.psfm.status["image_list"] if image["state"] == "placed"]

    @cached_property
    def placed(self):
        """Names, of parts of at least five images."""
        return {image["name"] for image in self._placed if image["part"] in self._sizes}

    @property
    def outliers(self):
        rows = self.result.psfm.rows
        return rows[-1].outliers if rows else None

    def differs_from(self, other):
        """In which images are placed, in how many parts, or by a camera that is wrong; failures do, too."""
        if self.result is None:
            return True
        return bool(self.outliers) or (other is not None and other.result is not None and
                                       (self.placed, len(self.parts)) != (other.placed, len(other.parts)))


@dataclass
class Scene:
    """A row of the table for each mode."""
    name: str
    images: list
    known: bool     # with a reference of its own, not psfm's
    orders: tuple   # of the command line's, those of the scene
    cells: dict     # (order, mode) -> Cell

    def yardstick(self):
        """What the others are to end like: all at once in deterministic mode, or the first that did not fail."""
        at_once = self.cells.get(("batch", "deterministic"))
        return at_once if at_once and at_once.result else next(
            (cell for cell in self.cells.values() if cell.result), None)

    def deviating(self, mode):
        return [cell for (_, of), cell in self.cells.items() if of == mode and cell.differs_from(self.yardstick())]


class Sessions:
    """Of one scene; each is made once, whoever asks."""

    def __init__(self, settings, experiment, source):
        self.settings, self.experiment, self.source = settings, experiment, source
        self.runs = {run.name: run for run in experiment.runs if run.source is source}
        self._made = {}

    def session(self, order, mode):
        """@return (its folder, what it was given, psfm_session.Session)"""
        if (order, mode) not in self._made:
            run = self.runs[order]
            given = resolve(self.settings, run, matches_for(self.settings, run))
            say(f"{self.experiment.name}, {self.source.name}, {run.words}, {mode} mode: {len(given.names)} images")
            folder = (self.settings.work / self.experiment.name / self.source.name /
                      (f"{order}-{mode}" + (f"-first-{self.settings.images}" if self.settings.images else "")))
            options = [option for option in MODES[mode] if option != "--deterministic"]
            made = psfm_session.run_session(self.settings, folder / "psfm", given, batch=run.batch,
                                            deterministic="--deterministic" in MODES[mode], options=options)
            self._made[order, mode] = folder, given, made
        return self._made[order, mode]

    def reference(self):
        """(model, notes of the session that made it or None): what is known, or what psfm makes of all at once."""
        given = resolve(self.settings, self.runs["batch"])
        if given.reference is not None:
            return given.reference, None
        _, _, session = self.session("batch", "deterministic")
        return psfm_session.export_model(self.settings, session), session.record

    def result(self, order, mode):
        folder, given, session = self.session(order, mode)
        reference, made_by = self.reference()
        result = RunResult(self.runs[order], given, folder, measured(self.settings, session, reference, made_by))
        result.commands.append(session.record["command"])
        if made_by is None and mode == "deterministic" and order in WAYS:
            result.colmap = self._colmap(folder, given, session)
        return result

    def _colmap(self, folder, given, session):
        """Continued from its own model, fed the session's matches in the session's order."""
        if not self.settings.colmap:
            return None
        database = given.database or psfm_session.export_database(self.settings, session)[0]
        return run_colmap(self.settings, folder / "colmap", given, database, batch=False)


def _cell(sessions, order, mode):
    cell = Cell(sessions.source.name, order, mode)
    try:
        cell.result = sessions.result(order, mode)
    except Failed as failure:
        say(f"{cell.scene}, {order}, {mode} mode: {failure}")  # one failure is a cell of the table, not its end
    return cell


def _scene(settings, experiment, source):
    sessions = Sessions(settings, experiment, source)
    orders = tuple(name for name in sessions.runs if not settings.orders or name in settings.orders)
    images = resolve(settings, sessions.runs["names"]).names
    modes = MODES if source is scenes.STREET else OF_ALL
    cells = {(order, mode): _cell(sessions, order, mode)
             for mode in settings.modes or modes if mode in modes for order in orders}
    return Scene(source.name, images, source.reference is not None, orders, cells)


def run_orders(settings, experiment):
    """@return [Scene]"""
    if settings.database is not None:
        raise Failed("--database has the matches of one scene, and the table is of many; --share-matches looks at each "
                     "scene's photographs once")
    sources = dict.fromkeys(run.source for run in experiment.runs)
    return [_scene(settings, experiment, source) for source in sources
            if not settings.scenes or source.name in settings.scenes]
