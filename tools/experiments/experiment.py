# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""One experiment: every order through psfm and COLMAP, then measured."""
from dataclasses import dataclass, field, replace
from pathlib import Path

import measurements
import psfm_session
from colmap_progressive import run_colmap
from console import Failed, say
from scenes import Photographs, Run
from sources import Input, resolve


@dataclass
class PsfmResult:
    record: dict
    status: dict
    log: measurements.Log
    evaluation: dict | None
    rows: list


@dataclass
class RunResult:
    run: Run
    given: Input
    folder: Path
    psfm: PsfmResult
    psfm_batch: PsfmResult | None = None  # on the same matches; of the first run on the same images
    colmap: dict | None = None
    commands: list = field(default_factory=list)


def measured(settings, session, reference, made_by=None):
    status = psfm_session.status_of(settings, session)
    lines = session.log.read_text(errors="replace").splitlines()
    log = measurements.parse_log(lines, session.log)
    evaluation = psfm_session.evaluate_session(settings, session, reference, made_by)
    differ = measurements.disagreements(log.rows, evaluation)
    if differ:
        image, logged, stored = differ[0]
        say(f"  note: after image {image} the log has {logged} placed and the version that is kept {stored} "
            f"({len(differ)} such images); the plot shows what is kept")
    rows = measurements.add_versions(log.rows, evaluation)
    return PsfmResult(session.record, status, log, evaluation, measurements.set_final(rows, status, evaluation))


def _shared_matches(settings, run):
    """Matches of all of a run's photographs, found once and used in every order."""
    folder = settings.work / "matches" / run.source.name
    everything = Run(run.source.name, run.source, ("names",), "")
    say(f"matches of {run.source.name}")
    session = psfm_session.run_session(replace(settings, images=None, again=False), folder / "batch",
                                       resolve(replace(settings, images=None), everything), batch=True)
    return psfm_session.export_database(settings, session)[0]


def matches_for(settings, run):
    if not isinstance(run.source, Photographs):
        return None
    if settings.database is not None:
        return settings.database
    return _shared_matches(settings, run) if settings.share_matches else None


def run_one(settings, experiment, run, *, first):
    """@param first  also in batch mode: that does not depend on the order, so once for the same images is enough"""
    given = resolve(settings, run, matches_for(settings, run))
    say(f"{experiment.name}, {run.words}: {len(given.names)} images")
    folder = settings.work / experiment.name / (run.name + (f"-first-{settings.images}" if settings.images else ""))
    session = psfm_session.run_session(settings, folder / "psfm", given)
    result = RunResult(run, given, folder, measured(settings, session, given.reference))
    result.commands.append(session.record["command"])
    database = given.database
    if database is None:
        database, command = psfm_session.export_database(settings, session)
        result.commands.append(command)
    if first:
        matches = replace(given, database=Path(database), identity=f"matches of {session.record}")
        batch = psfm_session.run_session(settings, folder / "psfm-batch", matches, batch=True)
        result.psfm_batch = measured(settings, batch, given.reference)
        result.commands.append(batch.record["command"])
    result.colmap = run_colmap(settings, folder / "colmap", given, database, batch=first)
    if result.colmap:
        result.commands += [step["command"] for step in result.colmap["steps"]]
        if result.colmap["batch"]:
            result.commands.append(result.colmap["batch"]["command"])
    if given.reference is not None:
        result.commands.append([str(settings.psfm), "evaluate", "--reference", str(given.reference), "--session",
                                str(session.folder), "--every-image", "--json"])
    return result


def run_experiment(settings, experiment):
    if settings.images is not None and settings.images < 2:
        raise Failed("--images wants at least 2")
    results, seen = [], set()
    for run in experiment.runs:
        results.append(run_one(settings, experiment, run, first=run.source not in seen))
        seen.add(run.source)
    return results
