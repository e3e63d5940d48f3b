# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a log, a status and an evaluation say, as one row an image that has arrived."""
import json
from dataclasses import dataclass, field

from console import Failed

SOLVE_KINDS = ("new", "extend", "transfer", "settle")


@dataclass
class Row:
    """The session once `arrived` images were in it; None where nothing is known."""
    arrived: int
    placed: int = 0
    clusters: int = 0
    effective: int = 0
    resets: int = 0
    latency_ms: float | None = None
    outliers: int | None = None          # over effective clusters of at least five cameras
    largest: int | None = None           # images in the largest effective cluster
    largest_outliers: int | None = None
    ate_mean: float | None = None        # of the largest


@dataclass
class Log:
    rows: list = field(default_factory=list)
    events: list = field(default_factory=list)     # (image that brought it about, kind, text)
    solves: dict = field(default_factory=dict)     # kind -> [number, milliseconds]
    merge_ms: float = 0.0

    @property
    def solve_ms(self):
        return sum(milliseconds for _, milliseconds in self.solves.values())


def parse_log(lines, where="the log"):
    """A --log of psfm. A session that was continued may repeat an image: the later line counts."""
    log, images, pending = Log(), {}, []
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            entry = json.loads(line)
            kind = entry["event"]
        except (json.JSONDecodeError, KeyError, TypeError) as error:
            raise Failed(f"{where} line {number} is no line of a psfm log; --again makes the session anew") from error
        if kind == "image":
            row = Row(entry["index"], entry["placed"], entry["clusters"], entry["effective_clusters"],
                      entry["resets"], entry.get("latency_ms"))
            images[row.arrived] = row
            log.merge_ms += entry.get("stages_ms", {}).get("merge") or 0.0
            log.events += [(row.arrived, *event) for event in pending]
            pending = []
        elif kind == "solve":
            count = log.solves.setdefault(entry.get("kind", "failed"), [0, 0.0])
            count[0] += 1
            count[1] += entry.get("milliseconds") or 0.0
        elif kind != "nodes":
            pending.append((kind, entry.get("text", "")))
    log.rows = [images[index] for index in sorted(images)]
    log.events += [(log.rows[-1].arrived if log.rows else 0, *event) for event in pending]
    return log


def disagreements(rows, evaluation):
    """(image, placed by the log, placed by the version that is kept) where they differ; equal in a sound session.

    REQUIRES: add_versions was not called yet. The last image is left out: its log line comes before the end's work.
    """
    versions = {version["image"]: version["placed"] for version in (evaluation or {}).get("versions") or []}
    return [(row.arrived, row.placed, versions[row.arrived]) for row in rows[:-1]
            if versions.get(row.arrived, row.placed) != row.placed]


def add_versions(rows, evaluation):
    """Joins `psfm evaluate --every-image` to the rows. A version holds until the next one."""
    versions = {version["image"]: version for version in (evaluation or {}).get("versions") or []}
    current = None
    for row in rows:
        current = versions.get(row.arrived, current)
        if current is None:
            if versions:
                row.outliers = 0  # nothing placed yet
            continue
        largest = current["largest"] or {}
        row.outliers = current["outliers"]
        row.placed, row.effective = current["placed"], current["effective_clusters"]
        row.largest, row.largest_outliers = largest.get("registered"), largest.get("outliers")
        row.ate_mean = largest.get("ate_mean")
    return rows


def set_final(rows, status, evaluation):
    """The last row tells of the finished session: models are adjusted once more after the last image."""
    if not rows:
        return rows
    last = rows[-1]
    last.placed, last.clusters = status["placed"], status["clusters"]
    last.effective, last.resets = status["effective_clusters"], status["resets"]
    models = (evaluation or {}).get("models") or []
    if models:
        last.outliers = sum(model["outliers"] or 0 for model in models if model["registered"] >= 5)
        last.largest, last.largest_outliers = models[0]["registered"], models[0]["outliers"]
        last.ate_mean = models[0]["ate_mean"]
    return rows


def holds_from(rows, holds):
    """The number of images from which on `holds` is true of every row; None if it is not in the end."""
    start = None
    for row in rows:
        if not holds(row):
            start = None
        elif start is None:
            start = row.arrived
    return start


def summed_outliers(rows):
    """Over all states of the session, each as it was after one more image: how much was ever shown wrong."""
    known = [row.outliers for row in rows if row.outliers is not None]
    return sum(known) if known else None


def most_outliers(rows, after=20):
    known = [row.outliers for row in rows if row.arrived > after and row.outliers is not None]
    return max(known, default=None)


def _nearly_all_right(row):
    return (row.largest is not None and row.largest_outliers is not None and
            row.largest >= 0.95 * row.arrived and row.largest_outliers <= 0.02 * row.largest)


# Key, whether a reference is needed, words, and how it is measured. The percentages are those of the project's goals.
MILESTONES = (
    ("most_outliers", True, "most outliers at any time after image 20", most_outliers),
    ("nearly_all_right", True, "at least 95 % of the arrived in one effective cluster, at most 2 % of them outliers, "
     "from image", lambda rows: holds_from(rows, _nearly_all_right)),
    ("no_outlier_and_placed", True, "no outlier, and at least 90 % of the arrived placed, from image",
     lambda rows: holds_from(rows, lambda row: row.outliers == 0 and row.placed >= 0.9 * row.arrived)),
    ("one_effective", False, "one effective cluster from image",
     lambda rows: holds_from(rows, lambda row: row.effective == 1)),
    ("one_cluster", False, "one cluster from image", lambda rows: holds_from(rows, lambda row: row.clusters == 1)),
    ("most_clusters", False, "most clusters at any time",
     lambda rows: max((row.clusters for row in rows), default=None)),
)


def row_at(rows, arrived):
    """The state after that many images."""
    return next((row for row in reversed(rows) if row.arrived <= arrived), None)
