# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""One order of arrival through psfm, and what its session and its log say about it."""
import datetime
from dataclasses import dataclass
from pathlib import Path

import orders
from console import Failed, answer, answer_json, call, load_average, machine, say
from kept import Kept, digest_of_file, digest_of_names


@dataclass(frozen=True)
class Session:
    folder: Path
    log: Path
    record: dict  # what was noted when it was made


def identity_of(psfm):
    """Which program made a session, as far as a person can find it again."""
    try:
        version, _, commit = answer([psfm, "--version"]).strip().partition(" ")
    except Failed as failure:
        raise Failed(f"{failure}; build it (cmake --preset release && cmake --build --preset release), or give "
                     "--psfm FILE") from failure
    return {"version": version, "sha": digest_of_file(psfm), "commit": commit.strip("()")}


def _notes(psfm, command, seconds, load):
    return {"psfm": identity_of(psfm), "command": [str(word) for word in command], "seconds": seconds,
            "load": load, "machine": machine(), "date": datetime.date.today().isoformat()}


def _manner(batch, deterministic):
    if batch:
        return " at once"
    return " one after the other" if deterministic else ", several in flight"


def run_session(settings, folder, given, *, batch=False, deterministic=None, options=()):
    """A finished session in `folder`: taken as it is, continued, or made.

    @param deterministic  None: where it is no batch
    @param options  further ones of `psfm run`
    """
    asked = {"order": digest_of_names(given.names), "from": given.identity, "batch": batch}
    if deterministic is None:
        deterministic = not batch
    elif deterministic == batch:
        asked["deterministic"] = deterministic  # unsaid otherwise, so that older sessions are still known
    if options:
        asked["options"] = list(options)
    kept = Kept(folder, asked)
    session, log = kept.folder / "session", kept.folder / "log.jsonl"
    record = None if settings.again else kept.record()
    if record is not None:
        if record["psfm"]["sha"] != identity_of(settings.psfm)["sha"]:
            maker = record["psfm"]["commit"] or record["psfm"]["sha"]
            say(f"  {session} was made by another build of psfm ({maker}, {record['date']}); --again makes it anew")
        return Session(session, log, record)

    order = kept.folder / "order.txt"
    options = ["--session", session, "--log", log, *(["--batch"] if batch else []),
               *(["--deterministic"] if deterministic else []), *options]
    if given.database is not None:
        command = [settings.psfm, "import", "--colmap-database", given.database, "--order", order, *options]
    else:
        command = [settings.psfm, "run", given.photographs, "--order", order, *options]
    load = load_average()
    if kept.is_begun() and session.exists() and not settings.again:
        say(f"  psfm, continuing {session} …")
        try:
            call([settings.psfm, "resume", "--session", session, "--log", log], kept.folder / "psfm.txt")
        except Failed as failure:
            raise Failed(f"{failure}\nThe run was interrupted, and cannot be continued; --again makes it anew") \
                from failure
        seconds = None  # of the first attempt, nobody knows
    else:
        say(f"  psfm, {len(given.names)} images{_manner(batch, deterministic)} …")
        kept.begin()
        orders.write_order(order, given.names)
        seconds, _ = call(command, kept.folder / "psfm.txt")
    return Session(session, log, kept.finish(_notes(settings.psfm, command, seconds, load)))


def export_database(settings, session):
    """The session's verified matches as a COLMAP database, and the command that wrote it."""
    target = session.folder.parent / "matches"
    command = [settings.psfm, "export", "--session", session.folder, "--format", "colmap-database", "--output", target]
    kept = Kept(target, {"session": session.record})
    if kept.record() is None:
        say("  writing its matches for COLMAP …")
        kept.begin()
        call(command, kept.folder / "export.txt")
        kept.finish({})
    return target / "database.db", [str(word) for word in command]


def status_of(settings, session):
    """What `psfm status --json` says. Kept beside the session: pages are drawn again where sessions are no more."""
    kept = Kept(session.folder.parent / "status", {"session": session.record})
    record = kept.record()
    if record is None:
        record = answer_json([settings.psfm, "status", "--session", session.folder, "--json"])
        kept.begin()
        kept.finish(record)
    return record


def export_model(settings, session):
    """The largest effective cluster as a COLMAP model."""
    kept = Kept(session.folder.parent / "model", {"session": session.record})
    if kept.record() is None:
        kept.begin()
        call([settings.psfm, "export", "--session", session.folder, "--format", "colmap", "--output",
              kept.folder / "models"], kept.folder / "export.txt")
        kept.finish({})
    return kept.folder / "models/0"


def evaluate_session(settings, session, reference, made_by=None):
    """`psfm evaluate` of every version; None where there is nothing to judge. Kept beside the session.

    @param made_by  notes of the session whose model the reference is, where it is one
    """
    if reference is None:
        return None
    kept = Kept(session.folder.parent / "evaluation",
                {"session": session.record, "psfm": identity_of(settings.psfm)["sha"], "reference": str(reference),
                 **({"made_by": made_by} if made_by else {})})
    record = kept.record()
    if record is None:
        say("  judging what it looked like after every image …")
        record = answer_json([settings.psfm, "evaluate", "--reference", reference, "--session", session.folder,
                              "--every-image", "--json"], accept=None)
        kept.begin()
        kept.finish(record)
    return record
