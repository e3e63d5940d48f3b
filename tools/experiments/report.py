# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What was measured, as a page."""
import os
import shlex
import textwrap

import measurements
import orders
from colmap_progressive import colmap_version

MOST_EVENTS = 12


def number(value, digits=0):
    """A dash for what was not measured."""
    if value is None:
        return "–"
    return f"{value:,.{digits}f}"


def significant(value, unit=""):
    return "–" if value is None else f"{value:.3g}{unit}"


def seconds(value):
    return "–" if value is None else number(value, 1 if value < 100 else 0)


def filled(text, indent=""):
    return textwrap.fill(" ".join(text.split()), 118, subsequent_indent=indent, break_long_words=False,
                         break_on_hyphens=False)


def paragraph(text):
    return filled(text) + "\n"


def item(text):
    """Of a list."""
    return filled(f"- {text}", indent="  ") + "\n"


def shell_command(words):
    """As a block, which a shell takes as it stands. @param words  quoted"""
    lines = ["    " + words[0]]
    for word in words[1:]:
        if len(lines[-1]) + len(word) > 110:
            lines[-1] += " \\"
            lines.append("       ")
        lines[-1] += " " + word
    return "\n".join(lines) + "\n"


def table(head, rows, words=1):
    """@param words  so many columns hold text, the others numbers"""
    align = ["---"] * words + ["--:"] * (len(head) - words)
    return "".join("| " + " | ".join(row) + " |\n" for row in [head, align, *rows])


def page_of(parts):
    """A page's text: parts with an empty line between them; what is empty is left out."""
    return "\n".join(part if part.endswith("\n") else part + "\n" for part in parts if part)


def _psfm_cells(program, order, psfm):
    final = psfm.rows[-1] if psfm.rows else measurements.Row(0)
    model = ((psfm.evaluation or {}).get("models") or [{}])[0]
    relative = model.get("ate_rel")
    return [order, program, number(final.placed), number(final.largest), number(final.outliers),
            number(final.effective), number(final.clusters), number(psfm.status["resets"]),
            significant(model.get("ate_mean")), significant(relative and 100 * relative, " %"),
            seconds((psfm.log.solve_ms + psfm.log.merge_ms) / 1000), seconds(psfm.record["seconds"])]


def _colmap_cells(program, order, end):
    relative = end["ate_rel"]
    return [order, program, number(end["placed"]), number(end["largest"]), number(end["outliers"]),
            number(end["models"]), "–", "–", significant(end["ate_mean"]),
            significant(relative and 100 * relative, " %"), seconds(end["seconds"]), "–"]


def results_table(results):
    rows = []
    for result in results:
        order = result.run.words
        rows.append(_psfm_cells("psfm, progressive", order, result.psfm))
        if result.colmap:
            end = result.colmap["steps"][-1]
            until = f" to image {end['images']}" if end["images"] < len(result.given.names) else ""
            rows.append(_colmap_cells(f"COLMAP {result.colmap['version']}, continued{until}", order, end))
    several = len({result.run.source for result in results}) > 1
    for result in results:
        at_once = f"all of {result.run.source.name} at once" if several else "all at once"
        if result.psfm_batch:
            rows.append(_psfm_cells("psfm, batch", at_once, result.psfm_batch))
        if result.colmap and result.colmap["batch"]:
            rows.append(_colmap_cells(f"COLMAP {result.colmap['version']}, batch", at_once,
                                      result.colmap["batch"]))
    return table(["order", "program", "placed", "in the largest", "outliers", "effective clusters", "clusters",
                  "recoveries", "mean error", "relative error", "solving [s]", "whole [s]"], rows, words=2)


def milestones_table(results, paper):
    rows = []
    for key, needs_reference, words, measure in measurements.MILESTONES:
        judged = [result for result in results if result.given.reference or not needs_reference]
        if not judged:
            continue
        cells = [number(measure(result.psfm.rows)) if result in judged else "–" for result in results]
        rows.append([words, *cells, *([number(paper.get(key))] if paper else [])])
    head = ["", *(result.run.words for result in results), *(["the paper's figure"] if paper else [])]
    return table(head, rows)


def over_time_table(result):
    steps = {step["images"]: step for step in result.colmap["steps"]} if result.colmap else {}
    rows = []
    for count in orders.step_plan(len(result.given.names)):
        row = measurements.row_at(result.psfm.rows, count)
        cells = [row.placed, row.outliers, row.clusters, row.effective] if row else [None] * 4
        step = steps.get(count, {})
        cells += [step.get("placed"), step.get("outliers"), step.get("models")] if steps else []
        rows.append([str(count), *map(number, cells)])
    head = ["arrived", "psfm: placed", "outliers", "clusters", "effective"]
    return table(head + (["COLMAP: placed", "outliers", "models"] if steps else []), rows, words=0)


def work_table(results):
    """Solves that were skipped, and how the others began; their time against one batch reconstruction."""
    batches = {result.run.source: result.psfm_batch.log for result in results if result.psfm_batch}
    rows = []
    for result in results:
        batch = batches.get(result.run.source)
        batch_s = (batch.solve_ms + batch.merge_ms) / 1000 if batch else None
        status, log = result.psfm.status, result.psfm.log
        spent = (log.solve_ms + log.merge_ms) / 1000
        counts = [status.get(f"solves_{kind}") for kind in ("skipped", "coalesced", "extend", "transfer", "new",
                                                            "settle")]
        ratio = number(spent / batch_s, 2) if batch_s else "–"
        rows.append([result.run.words, *map(number, counts), seconds(spent), seconds(batch_s), ratio])
    return table(["order", "skipped", "coalesced", "extended", "transferred", "new", "settled", "all solves [s]",
                  "batch [s]", "ratio"], rows)


def events_text(result):
    kinds = {}
    for _, kind, _ in result.psfm.log.events:
        kinds[kind] = kinds.get(kind, 0) + 1
    if not kinds:
        return "No cluster was reset, split, joined or moved.\n"
    counts = ", ".join(f"{count} × {kind}" for kind, count in sorted(kinds.items()))
    shown = [event for event in result.psfm.log.events if event[1] == "reset"] or result.psfm.log.events
    lines = [item(f"image {image}, {kind}: {text}") for image, kind, text in shown[:MOST_EVENTS]]
    more = f"- … and {len(shown) - MOST_EVENTS} more\n" if len(shown) > MOST_EVENTS else ""
    return f"Events: {counts}.\n\n" + "".join(lines) + more


def short_path(settings, result, word):
    """Nothing of this machine's own folders on the page: the run's is where the commands are given."""
    if word == str(settings.psfm):
        return "psfm"
    if word.startswith(str(result.folder) + os.sep):
        return word[len(str(result.folder)) + 1:]
    for folder, name in ((settings.work, "$WORK"), (settings.datasets, "$PSFM_DATASETS"),
                         (settings.database and settings.database.parent, "$MATCHES")):
        if folder and (word == str(folder) or word.startswith(str(folder) + os.sep)):
            return name + word[len(str(folder)):]
    return word


def commands_text(settings, result):
    blocks = []
    for command in result.commands:
        words = [short_path(settings, result, word) for word in command]
        blocks.append(shell_command([word if word.startswith("$") and shlex.quote(word[1:]) == word[1:]
                                     else shlex.quote(word) for word in words]))
    folder = "$WORK/" + result.folder.relative_to(settings.work).as_posix()
    return f"{result.run.words}, in `{folder}`:\n\n" + "".join(blocks)


def in_short(results):
    """One line for the overview."""
    parts = []
    for result in results:
        final = result.psfm.rows[-1] if result.psfm.rows else measurements.Row(0)
        words = f"{result.run.words}, psfm placed {final.placed} of {len(result.given.names)}"
        words += f" ({number(final.outliers)} outliers)" if result.given.reference else ""
        if result.colmap:
            end = result.colmap["steps"][-1]
            part = f" of {end['images']}" if end["images"] < len(result.given.names) else ""
            words += f", COLMAP {end['placed']}{part}"
            words += f" ({number(end['outliers'])})" if result.given.reference else ""
        parts.append(words)
    return "In short: " + "; ".join(parts) + "."


def _one(values):
    return " and ".join(sorted(set(values)))


def measured_when(records):
    """When, with which psfm and where sessions were made: a sentence without its end."""
    psfm = _one(f"{record['psfm']['version']} ({record['psfm']['commit'] or record['psfm']['sha']})"
                for record in records)
    loads = [record["load"] for record in records]
    dates = sorted({record["date"] for record in records})
    span = dates[0] + (f" to {dates[-1]}" if len(dates) > 1 else "")
    load = f"{min(loads)}" + (f" to {max(loads)}" if max(loads) > min(loads) else "")
    machines = _one(record["machine"] for record in records)
    return (f"Measured {span} with psfm {psfm} on {machines}, where other programs made for a load of {load} "
            "when psfm was started")


def provenance(settings, results):
    text = measured_when([result.psfm.record for result in results]) + ": compare times as ratios. "
    colmaps = {result.colmap["version"] for result in results if result.colmap}
    if colmaps:
        text += f"COLMAP {_one(colmaps)} was fed the same verified matches in the same order"
        text += (f", up to {settings.colmap_until} images (`--colmap-until`). " if settings.colmap_until else ". ")
    elif settings.colmap and colmap_version() is None:
        text += "COLMAP is not installed there (`apt-get install colmap`), so there is nothing to compare with. "
    elif not settings.colmap:
        text += "COLMAP was left out (`--no-colmap`). "
    if any(result.given.database and result.given.photographs for result in results):
        text += "The matches came from a database, as in the paper's experiments, and not from the photographs. "
    return paragraph(text)


def left_out(settings):
    """Said where a table is not whole: what it is of."""
    chosen = {name: given for name, given in settings.parts().items() if given}
    if not chosen and not settings.images:
        return ""
    words = [f"{name} {', '.join(given)}" for name, given in chosen.items()]
    words += [f"the first {settings.images} images of each order"] if settings.images else []
    return paragraph(f"**A part of the table only:** {'; '.join(words)}.")


def again(settings, experiment):
    words = f"tools/experiments/run {experiment.name}"
    words += "".join(f" --{name} {' '.join(given)}" for name, given in settings.parts().items() if given)
    words += f" --images {settings.images}" if settings.images else ""
    words += " --share-matches" if settings.share_matches else ""
    words += f" --database $MATCHES/{settings.database.name}" if settings.database else ""
    words += f" --colmap-until {settings.colmap_until}" if settings.colmap_until else ""
    return words + ("" if settings.colmap else " --no-colmap")


def write_page(settings, experiment, results, plots):
    """@param plots  SVG file names, one a result"""
    parts = [f"# {experiment.title}\n", paragraph(experiment.about)]
    if settings.images:
        parts.append(f"**A trial with the first {settings.images} images of each order.** What stands for \"at once\" is "
                     "the first order's images.\n")
    parts += [paragraph(in_short(results)), provenance(settings, results), "## Result\n", results_table(results),
              "What the columns mean is told in [README.md](README.md).\n", "## While the images arrive\n"]
    for result, plot in zip(results, plots, strict=True):
        parts += [f"### {result.run.words[0].upper() + result.run.words[1:]}\n",
                  f"![{experiment.title}, {result.run.words}]({plot})\n", over_time_table(result), events_text(result)]
    parts += ["## From when on\n", milestones_table(results, experiment.paper),
              paragraph("A dash: not so in the end" + (", or not reported by the paper." if experiment.paper else ".")),
              "## Work saved\n", work_table(results),
              "## Commands\n",
              paragraph(f"All of it: `{again(settings, experiment)}`. What that ran, where `$WORK` is its `--work`" +
                        (" and `$MATCHES` the folder of the database:" if settings.database else ":"))]
    parts += [commands_text(settings, result) for result in results]
    file = settings.output / f"{experiment.name}.md"
    file.write_text(page_of(parts))
    return file
