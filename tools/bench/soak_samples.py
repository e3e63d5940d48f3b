# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a process holds while it runs: memory, open files, its session on the disk; and what a run is judged by."""
import os
from dataclasses import dataclass
from pathlib import Path

from arithmetic import quotient
from report import number, table
from watched import resident_mib

MEMORY_GROWTH = 0.05  # of the last third over the middle third, at most
JUDGED_MINUTES = 20   # shorter runs are still filling their caches in the middle
SHORT_FILES = 3       # descriptors that a shorter run may still open for good


@dataclass
class Sample:
    seconds: float
    images: int          # acknowledged
    rss_mib: float
    processor: float     # [s]
    tables: int          # open files of RocksDB's tables: as many as the session has, however many that is
    others: int          # other descriptors
    store_mib: float
    waiting: int         # photographs in the folder without an answer


def open_files(pid):
    """(tables, others) or None when the process has ended"""
    tables = others = 0
    try:
        for link in Path(f"/proc/{pid}/fd").iterdir():
            try:
                target = os.readlink(link)
            except OSError:
                continue  # closed meanwhile
            if target.removesuffix(" (deleted)").endswith(".sst"):
                tables += 1
            else:
                others += 1
    except OSError:
        return None
    return tables, others


def bytes_in(folder):
    """Of files that may be deleted meanwhile."""
    total = 0
    for parent, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.stat(os.path.join(parent, name)).st_size
            except FileNotFoundError:
                continue
    return total


def take_sample(pid, seconds, images, session, waiting):
    """None when the process has ended"""
    memory, files = resident_mib(pid), open_files(pid)
    try:
        times = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return None
    if memory is None or files is None:
        return None
    processor = (int(times[11]) + int(times[12])) / os.sysconf("SC_CLK_TCK")
    return Sample(round(seconds, 1), images, round(memory, 1), processor, *files, round(bytes_in(session) / 2**20, 1), waiting)


def thirds(samples):
    """Of the time since the first image was acknowledged, not of the samples."""
    samples = [sample for sample in samples if sample.images > 0]
    if not samples:
        return [None] * 3
    begin, end = samples[0].seconds, samples[-1].seconds
    parts = [[], [], []]
    for sample in samples:
        parts[min(2, int(3 * (sample.seconds - begin) / max(end - begin, 1e-9)))].append(sample)
    return [summary(part) for part in parts]


def summary(part):
    if not part:
        return None
    memory = [sample.rss_mib for sample in part]
    return {"images": part[-1].images, "rss_mib": round(sum(memory) / len(memory), 1), "rss_mib_most": max(memory),
            "others_least": min(sample.others for sample in part), "others_most": max(sample.others for sample in part),
            "tables_most": max(sample.tables for sample in part), "store_mib": part[-1].store_mib,
            "waiting_most": max(sample.waiting for sample in part)}


def table_of(parts):
    rows = [[name, str(part["images"]), number(part["rss_mib"]), number(part["rss_mib_most"]),
             f"{part['others_least']}–{part['others_most']}", str(part["tables_most"]), number(part["store_mib"]),
             str(part["waiting_most"])]
            for name, part in zip(("first", "middle", "last"), parts) if part]
    return table(["third", "images at its end", "memory, mean [MiB]", "at most [MiB]", "descriptors but tables",
                  "tables open, at most", "session [MiB]", "photographs waiting, at most"], rows)


def growth(parts):
    """Of the mean memory, from the middle to the last third."""
    if None in parts:
        return None
    return quotient(parts[2]["rss_mib"], parts[1]["rss_mib"]) - 1


def judge(parts, minutes):
    """What the samples say against the promises, in words. Nothing here is about time."""
    if None in parts:
        return []
    broken = []
    if minutes >= JUDGED_MINUTES and growth(parts) > MEMORY_GROWTH:
        broken.append(f"memory grew by {100 * growth(parts):.1f} % from the middle to the last third")
    # What is open for a moment does not count: a leak raises the least that is open, too.
    allowed = 0 if minutes >= JUDGED_MINUTES else SHORT_FILES
    if parts[2]["others_least"] > parts[1]["others_least"] + allowed:
        broken.append(f"{parts[1]['others_least']} descriptors are always open in the middle third, "
                      f"{parts[2]['others_least']} in the last")
    return broken
