# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Results as JSON files, one a part, and performance.md from all that are there."""
import json

from parts import PARTS
from report import paragraph

MARKER = "<!-- What follows is written by tools/bench/run, from the JSON files in performance/. -->"
HEAD = """\
# Performance

`tools/bench/run NAME` repeats what stands here (`--list` names the parts).
"""


def write_result(output, name, record):
    folder = output / "performance"
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name}.json"
    file.write_text(json.dumps(record, indent=None, separators=(",", ":")) + "\n")
    return file


def read_result(file):
    """As another process would find it."""
    return json.loads(file.read_text())["result"]


def _provenance(record):
    psfm = record["psfm"]
    return paragraph(f"Measured {record['date']} with psfm {psfm['version']} ({psfm['commit'] or psfm['sha']}) on "
                     f"{record['machine']}; other programs made for a load of {record['load']} when it began. "
                     f"`{record['command']}`")


def _section(output, part):
    file = output / "performance" / f"{part.name}.json"
    if not file.is_file():
        return ""
    record = json.loads(file.read_text())
    for name, svg in part.plots(record["result"]).items():
        (output / "performance" / name).write_text(svg)
    return f"## {part.title}\n\n{_provenance(record)}\n{part.section(record['result']).rstrip()}\n\n"


def write_page(output):
    """What stands above the marker is a person's, and stays."""
    page = output / "performance.md"
    head = page.read_text().split(MARKER)[0] if page.is_file() else HEAD + "\n"
    sections = "".join(_section(output, part) for part in PARTS)
    page.write_text(f"{head}{MARKER}\n\n{sections.rstrip()}\n")
    return page
