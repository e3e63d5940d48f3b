# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the command line asks for, and folders to work in."""
import datetime
import shlex
import shutil
from dataclasses import dataclass
from pathlib import Path

import orders
from console import Failed, load_average, machine
from psfm_session import identity_of
from sources import in_datasets, photograph_names

MARK = "made-by-bench"


@dataclass(frozen=True)
class Settings:
    datasets: Path | None
    psfm: Path
    work: Path
    scenes: tuple = ()          # names; none: the part's own
    images: int | None = None   # the first N only
    repeats: int = 1
    threads: int | None = None  # None: the machine's
    kept_colmap: bool = False   # COLMAP's last results, where the part keeps them
    command: tuple = ()         # as it was given, to be written down


def scratch(settings, name):
    """An empty folder. Only what a benchmark made is ever removed."""
    folder = settings.work / name
    if folder.exists():
        if not (folder / MARK).exists():
            raise Failed(f"{folder} holds files that no benchmark wrote; choose another --work")
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    (folder / MARK).touch()
    return folder


# Folders of whoever measured, and what stands for them in what is written down.
NAMED = {"--psfm": "PSFM", "--datasets": "DIR", "--work": "WORK", "--output": "OUT"}


def named_command(words):
    """As a line for the shell, with names in place of the folders of this machine."""
    named, option = [], ""
    for word in words:
        before, is_pair, _ = word.partition("=")
        named.append(NAMED.get(option) or (f"{before}={NAMED[before]}" if is_pair and before in NAMED else word))
        option = word
    return shlex.join(named)


def provenance(settings):
    """With what, on what and when; taken before the work begins, for the load to be that of others."""
    return {"psfm": identity_of(settings.psfm), "machine": machine(), "load": load_average(),
            "date": datetime.date.today().isoformat(), "command": named_command(settings.command)}


def chosen(settings, known):
    """Of the part's scenes those that were asked for, or all. @param known  {name: scene}"""
    if not settings.scenes:
        return list(known.values())
    strangers = [name for name in settings.scenes if name not in known]
    if strangers:
        raise Failed(f"there is no scene {strangers[0]} here; there are {', '.join(known)}")
    return [known[name] for name in settings.scenes]


def photographs_of(settings, scene):
    """@return (folder, names in file-name order, reference or None)"""
    folder = in_datasets(settings, scene.images)
    reference = in_datasets(settings, scene.reference) if scene.reference else None
    return folder, photograph_names(folder)[:settings.images], reference


def write_order(folder, names):
    file = folder / "order.txt"
    orders.write_order(file, names)
    return file


def thread_options(settings, option="--threads"):
    return [option, settings.threads] if settings.threads else []
