# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's plots of a progressive reconstruction: images, outliers and clusters over the images that arrived."""
from svg_plot import Panel, Series, draw

PSFM, EFFECTIVE, COLMAP, ARRIVED, RESET = "#1f5fa8", "#12a594", "#c8590b", "#8c959f", "#b3261e"


def plot_of(result, title):
    """@param result  experiment.RunResult"""
    rows, colmap = result.psfm.rows, result.colmap
    arrived = [row.arrived for row in rows]
    last = max([len(result.given.names), *arrived])

    def of(name):
        return [(row.arrived, getattr(row, name)) for row in rows]

    def of_colmap(name):
        return [(step["images"], step[name]) for step in colmap["steps"]]

    placed = Panel("placed images", [
        Series("arrived", [(0, 0), (last, last)], ARRIVED, dash="2 4", width=1.5),
        Series("psfm", of("placed"), PSFM),
    ], height=190)
    outliers = Panel("outlier cameras", [Series("psfm", of("outliers"), PSFM)])
    clusters = Panel("clusters", [
        Series("psfm, clusters", of("clusters"), PSFM, kind="steps"),
        Series("psfm, effective clusters", of("effective"), EFFECTIVE, kind="steps", dash="7 5", width=2.4),
    ], height=130)
    if any(row.largest not in (None, row.placed) for row in rows):
        placed.series.append(Series("psfm, in the largest", of("largest"), EFFECTIVE, dash="7 5"))
    if colmap:
        name = f"COLMAP {colmap['version']}"
        placed.series.append(Series(f"{name}, continued", of_colmap("placed"), COLMAP, kind="marks"))
        outliers.series.append(Series(f"{name}, continued", of_colmap("outliers"), COLMAP, kind="marks"))
    resets = resets_of(rows)
    if resets:
        clusters.series.append(Series("psfm, reset", [(at, 0) for at in resets], RESET, kind="ticks"))
    panels = [placed, outliers, clusters] if result.given.reference else [placed, clusters]
    final = rows[-1] if rows else None
    description = f"{title}: {last} images; in the end psfm has {final.placed} placed, {final.outliers} outliers, " \
                  f"{final.clusters} clusters, {final.effective} effective." if final else title
    return draw(title, description, "images arrived", last, panels)


def resets_of(rows):
    """After which images the count of resets rose."""
    before, at = 0, []
    for row in rows:
        if row.resets > before:
            at.append(row.arrived)
        before = row.resets
    return at
