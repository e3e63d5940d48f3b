# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Random parts of scenes with look-alikes: what is placed of them, what is wrong, and whether psfm says so."""
from dataclasses import dataclass, replace

import psfm_session
from console import Failed, say
from kept import Kept
from scenes import Run
from sources import resolve

LOOK_ALIKES = "look_alikes"  # in `psfm status --json`: why an image waits, and why a model is doubtful


@dataclass(eq=False)
class Subset:
    """A session at its end. Without a record it failed, and was said to."""
    run: Run
    record: dict | None = None      # what was noted when it was made
    status: dict | None = None
    evaluation: dict | None = None  # None: there is no model

    @property
    def _placed(self):
        return [image for image in self.status["image_list"] if image["state"] == "placed"]

    @property
    def placed(self):
        return len(self._placed)

    @property
    def parts(self):
        return len({image["part"] for image in self._placed})

    @property
    def waiting(self):
        """Images that wait because they could show another thing that looks alike."""
        return sum(image["state"] != "placed" and image["reason"] == LOOK_ALIKES for image in self.status["image_list"])

    @property
    def wrong(self):
        """Outliers of all parts, whatever their size; all images of a part that cannot be aligned."""
        models = (self.evaluation or {}).get("models") or []
        return sum(model["registered"] if model["outliers"] is None else model["outliers"] for model in models)

    @property
    def is_said(self):
        """Whether psfm calls a model doubtful for its look-alikes."""
        return any(LOOK_ALIKES in model["reasons"] for model in self.status["weak_models"])


def _linked(folder, given):
    """A folder with these photographs alone."""
    kept = Kept(folder / "links", {"photographs": str(given.photographs), "names": given.names})
    photographs = kept.folder / "photographs"
    if kept.record() is None:
        kept.begin()
        for name in given.names:
            (photographs / name).parent.mkdir(parents=True, exist_ok=True)
            (photographs / name).symlink_to(given.photographs / name)
        kept.finish({})
    return photographs


def _run_one(settings, experiment, run):
    given = resolve(settings, run)
    say(f"{experiment.name}, {run.source.name}, {run.words}")
    subset = Subset(run)
    try:
        folder = settings.work / experiment.name / run.source.name / run.name
        given = replace(given, photographs=_linked(folder, given))
        session = psfm_session.run_session(settings, folder / "psfm", given, deterministic=False)
        subset.status = psfm_session.status_of(settings, session)
        subset.evaluation = psfm_session.evaluate_session(settings, session, given.reference)
        if subset.placed and subset.evaluation is None:
            raise Failed(f"psfm evaluate says nothing of {session.folder}, which has {subset.placed} images placed")
        subset.record = session.record
    except Failed as failure:
        say(f"{run.source.name}, {run.words}: {failure}")  # one failure is a row of the table, not its end
    return subset


def run_subsets(settings, experiment):
    """@return [Subset]"""
    if settings.images or settings.share_matches or settings.database is not None:
        raise Failed("--images, --share-matches and --database are not for subsets: their sizes are given, and each is "
                     "looked at by itself")
    return [_run_one(settings, experiment, run) for run in experiment.runs
            if not settings.scenes or run.source.name in settings.scenes]
