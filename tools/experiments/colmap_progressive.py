# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""COLMAP's mapper on the same matches: continued from its own model as images arrive, and on all at once.

The paper's baseline in progressive mode, with what COLMAP offers for it: `mapper --input_path` continues the
largest model of the step before with the images that have arrived by then (`--image_list_path`).
"""
import shutil
from pathlib import Path

import orders
from colmap_model import models_in, registered_names
from console import Failed, answer, answer_json, call, load_average, say
from kept import Kept, digest_of_file, digest_of_names

# No window is opened, but COLMAP's Qt asks for a display.
ENVIRONMENT = {"QT_QPA_PLATFORM": "offscreen"}


def colmap_version():
    """ "3.8"; None where there is no COLMAP."""
    if shutil.which("colmap") is None:
        return None
    words = answer(["colmap", "help"], accept=None).split()
    return words[1] if len(words) > 1 and words[0] == "COLMAP" else "unknown"


def judge(settings, models, reference):
    """Placed images, and outliers summed over models of at least five cameras, as for psfm."""
    names = [registered_names(model) for model in models]
    result = {"placed": len(set().union(*names)), "largest": max(map(len, names), default=0), "models": len(models),
              "outliers": None, "ate_mean": None, "ate_rel": None}
    if reference is None:
        return result
    if not models:
        return {**result, "outliers": 0}
    judged = answer_json([settings.psfm, "evaluate", "--reference", reference, "--json", *models], accept=None)
    if judged is None:
        return result
    large = [model["outliers"] for model in judged["models"] if model["registered"] >= 5]
    largest = judged["models"][0]
    return {**result, "outliers": sum(filter(None, large)), "ate_mean": largest["ate_mean"],
            "ate_rel": largest["ate_rel"]}


class Mapper:
    """COLMAP on a copy of a database: opening one, COLMAP rewrites its header."""

    def __init__(self, settings, folder, database, photographs):
        self.settings, self.folder, self.database = settings, Path(folder), database
        self.photographs = photographs
        self.digest = digest_of_file(database)
        self.version = colmap_version()
        self.copy = self.folder / "database.db"

    def close(self):
        self.copy.unlink(missing_ok=True)

    def command(self, folder, start):
        # Without photographs colours cannot be taken from them, and neither program needs them here.
        images = self.photographs or self.folder
        command = ["colmap", "mapper", "--database_path", self.copy, "--image_path", images,
                   "--image_list_path", folder / "images.txt", "--output_path", folder / "models",
                   "--Mapper.extract_colors", "0"]
        return [str(word) for word in command + (["--input_path", start] if start else [])]

    def map(self, name, names, start=None, after=()):
        """One call of the mapper. What it made is kept as long as matches, images and earlier steps are the same."""
        kept = Kept(self.folder / name, {"matches": self.digest, "colmap": self.version,
                                         "images": digest_of_names(names), "after": list(after)})
        record = kept.record()
        if record is None:
            say(f"  COLMAP {self.version}, {len(names)} images{', continued' if start else ''} …")
            if not self.copy.exists():
                self.folder.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(self.database, self.copy)
            kept.begin()
            (kept.folder / "models").mkdir()
            orders.write_order(kept.folder / "images.txt", names)
            load = load_average()
            command = self.command(kept.folder, start)
            seconds, status = call(command, kept.folder / "colmap.txt", accept=None, env=ENVIRONMENT)
            # Status 1 without a model only says that there is none yet.
            if status != 0 and (status < 0 or models_in(kept.folder / "models")):
                say(f"  COLMAP ended with status {status}; {kept.folder / 'colmap.txt'} says more")
            record = kept.finish({"seconds": seconds, "status": status, "command": command, "load": load})
        return record, models_in(kept.folder / "models")


def steps_of(settings, count):
    """After how many images COLMAP is continued."""
    plan = orders.step_plan(count)
    return [step for step in plan if settings.colmap_until is None or step <= settings.colmap_until] or plan[:1]


def run_colmap(settings, folder, given, database, *, batch):
    """Steps of the progressive mode, and the batch model where `batch` asks for it; None without COLMAP."""
    if not settings.colmap or colmap_version() is None:
        return None
    if "--image_list_path" not in answer(["colmap", "mapper", "--help"], accept=None):
        raise Failed("this COLMAP's mapper has no --image_list_path; install Debian's (apt-get install colmap), "
                     "or leave it out (--no-colmap)")
    mapper = Mapper(settings, folder, database, given.photographs)
    result = {"version": mapper.version, "steps": [], "batch": None}
    try:
        start, after, seconds = None, [], 0.0
        for count in steps_of(settings, len(given.names)):
            record, models = mapper.map(f"step-{count:04d}", given.names[:count], start, after)
            seconds += record["seconds"]
            result["steps"].append({"images": count, "seconds": seconds, "load": record["load"],
                                    "command": record["command"], "status": record["status"],
                                    **judge(settings, models, given.reference)})
            start = models[0] if models else start
            after = [*after, count]
        if batch and settings.colmap_until is None:
            record, models = mapper.map("batch", given.names)
            result["batch"] = {"images": len(given.names), **record, **judge(settings, models, given.reference)}
    finally:
        mapper.close()
    return result
