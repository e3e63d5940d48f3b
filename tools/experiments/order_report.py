# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the table of orders."""
import measurements
import orders
from order_table import LEAST, MODES, WAYS
from report import again, left_out, number, page_of, paragraph, provenance, table

COLUMNS = 7  # orders beside one another
MOST_NAMES = 12

READING = f"""\
A cell is *placed / outliers / parts*. Images in parts of fewer than {LEAST} count as not placed. Outliers are those of
`psfm evaluate` ([README.md](README.md)), each part aligned by itself, against what *beside* names: known poses
(`reference`), or, where nothing is known, the model that psfm made of all at once in deterministic mode (`psfm`),
which shows what the order changes and not what is right. A row is marked where a session did not end like the one of
all at once in deterministic mode (where that is left out: like the first): other images placed, another number of
parts, or any outlier.
"""
WAY = """\
Every state of a deterministic session is judged, one after each image: *sum* adds up the outliers of all states,
*most* is the worst state, and *at the quarters* are the outliers once a quarter, a half, three quarters and all of the
images had arrived.
"""
WAY_OF_COLMAP = " COLMAP was continued from its own model at the quarters, with the same matches."


def _words_of(order, scenes):
    cells = [cell for scene in scenes for cell in scene.cells.values() if cell.order == order and cell.result]
    if order == "names":
        return "names"
    return cells[0].result.run.words.removeprefix("shuffled, ") if cells else order


def _cell_words(cell):
    if cell is None:
        return "–"
    if cell.result is None:
        return "failed"
    return f"{len(cell.placed)} / {number(cell.outliers)} / {len(cell.parts)}"


def _order_columns(scenes):
    """Orders in groups that fit beside one another."""
    names = list(dict.fromkeys(order for scene in scenes for order in scene.orders))
    return [names[i:i + COLUMNS] for i in range(0, len(names), COLUMNS)]


def _endings_table(scenes, mode, columns):
    rows = []
    for scene in scenes:
        cells = [scene.cells.get((order, mode)) for order in columns]
        if not any(cells):
            continue
        differs = any(cell in scene.deviating(mode) for cell in cells if cell)
        rows.append([scene.name, "reference" if scene.known else "psfm", number(len(scene.images)),
                     *map(_cell_words, cells), "**differs**" if differs else ""])
    words = [_words_of(order, scenes) for order in columns]
    return table(["scene", "beside", "photographs", *words, ""], rows, words=2)


def _difference(cell, scene):
    """What is not as it is with all at once."""
    if cell.result is None:
        return "failed"
    other, words = scene.yardstick(), []
    missing = sorted(other.placed - cell.placed)
    more = sorted(cell.placed - other.placed)
    for names, what in ((missing, "not placed: "), (more, "placed besides: ")):
        if names:
            rest = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
            words.append(what + ", ".join(names[:MOST_NAMES]) + rest)
    if len(cell.parts) != len(other.parts):
        words.append(f"parts of {', '.join(map(str, cell.parts)) or 'nothing'}")
    if cell.outliers:
        words.append(f"{cell.outliers} wrong")
    return "; ".join(words)


def _differences(scenes, modes):
    lines = [f"- {scene.name}, {_words_of(cell.order, scenes)}, {mode}: {_difference(cell, scene)}\n"
             for scene in scenes for mode in modes for cell in scene.deviating(mode)]
    return "".join(lines) or "Nowhere.\n"


def _way_rows(scene):
    for order in WAYS:
        cell = scene.cells.get((order, "deterministic"))
        if cell is None or cell.result is None:
            continue
        rows, colmap = cell.result.psfm.rows, cell.result.colmap
        quarters = orders.step_plan(len(cell.result.given.names))
        steps = {step["images"]: step["outliers"] for step in (colmap or {"steps": []})["steps"]}
        states = [measurements.row_at(rows, count) for count in quarters]
        yield [scene.name, cell.result.run.words, number(measurements.summed_outliers(rows)),
               number(measurements.most_outliers(rows, after=0)),
               ", ".join(number(row.outliers if row else None) for row in states),
               ", ".join(number(steps.get(count)) for count in quarters) if colmap else ""]


def _way(scenes):
    rows = [row for scene in scenes if scene.known for row in _way_rows(scene)]
    if not rows:
        return ""
    head = ["scene", "order", "psfm: sum", "most", "at the quarters", "COLMAP: at the quarters"]
    beside = any(row[-1] for row in rows)
    if not beside:
        head, rows = head[:-1], [row[:-1] for row in rows]
    return "## On the way\n\n" + paragraph(WAY + (WAY_OF_COLMAP if beside else "")) + "\n" + table(head, rows, words=2)


def in_short(scenes, modes):
    """One line for the overview."""
    parts = []
    for mode in modes:
        shown = [scene for scene in scenes if any(of == mode for _, of in scene.cells)]
        differing = [f"{scene.name} in {len(scene.deviating(mode))} of "
                     f"{sum(of == mode for _, of in scene.cells)} orders"
                     for scene in shown if scene.deviating(mode)]
        parts.append(f"in {mode} mode {len(shown) - len(differing)} of {len(shown)} scenes end alike in every order "
                     "and without an outlier" + (f" (not {', '.join(differing)})" if differing else ""))
    return "In short: " + "; ".join(parts) + "."


def write_order_page(settings, experiment, scenes):
    modes = [mode for mode in settings.modes or MODES if any(of == mode for scene in scenes for _, of in scene.cells)]
    done = [cell.result for scene in scenes for cell in scene.cells.values() if cell.result]
    parts = [f"# {experiment.title}\n", paragraph(experiment.about), left_out(settings),
             paragraph(in_short(scenes, modes)), provenance(settings, done) if done else "", "## How sessions end\n",
             paragraph(READING)]
    for mode in modes:
        parts.append(f"### In {mode} mode\n")
        parts += [_endings_table(scenes, mode, columns) for columns in _order_columns(scenes)]
    parts += ["## Where they end differently\n", _differences(scenes, modes), _way(scenes), "## Commands\n",
              paragraph(f"All of it: `{again(settings, experiment)}`. A cell is `psfm run IMAGES --session SESSION "
                        "--order ORDER`, with `--deterministic`, `--camera-sharing all` and `--batch` where its mode and column say so, then "
                        "`psfm status --json` and `psfm evaluate --reference REFERENCE --session SESSION "
                        "--every-image`.")]
    file = settings.output / f"{experiment.name}.md"
    file.write_text(page_of(parts))
    return file
