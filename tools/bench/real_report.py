# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Ordinary photographs beside COLMAP: what was placed, where it stands, what it cost."""
from arithmetic import geometric_mean, median
from peers import ratio
from report import number, paragraph, significant, table

ABOUT = """\
psfm is run with no option given, in its default mode; COLMAP sees all photographs at once: feature_extractor with one
camera, exhaustive_matcher and mapper, on the processor, its defaults otherwise. Both have the same files, and take
turns. *Placed* is what the largest part (COLMAP: model) holds. *Rightly* placed is what of it stands within 5 % of the
bounding box's diagonal, once centres are aligned by what most of them agree on (least median of squares), with known
poses (`gt`, `centres.txt`), or with COLMAP's model where nothing is known; of photographs that the reference lacks
nothing is said. The median error is in per cent of the extent, the cameras' root mean square distance from their mean;
the mean error is in metres, of `psfm evaluate` where poses are known.
"""


def _middle(scene, program, key):
    values = [one[program][key] for one in scene["rounds"]]
    return median([value for value in values if value is not None])


def _worst(scene, program, key):
    """Of the rounds, since a photograph that is lost once is lost."""
    values = [one[program][key] for one in scene["rounds"]]
    return (max if key == "models" else min)(values)


def _aligned(scene, program, key):
    return median([one[program]["aligned"][key] for one in scene["rounds"] if one[program]["aligned"]])


def _rightly(scene, program):
    return min(one[program]["largest"] - (one[program]["aligned"] or {"beyond": 0})["beyond"]
               for one in scene["rounds"])


def _mean_error(scene, program):
    if scene["reference"] == "gt":
        return _middle(scene, program, "ate_mean")
    return _aligned(scene, program, "mean") if scene["reference"] == "centres.txt" else None


def _fewer(scene):
    """Fewer rightly placed than COLMAP has."""
    return _rightly(scene, "psfm") < _rightly(scene, "colmap")


def _placed_table(result):
    rows = []
    for name, scene in result["scenes"].items():
        counts = [number(count) for program in ("psfm", "colmap") for count in (
            _worst(scene, program, "largest"), _rightly(scene, program), _worst(scene, program, "models"))]
        rows.append([name, number(scene["images"]), *counts, "**fewer**" if _fewer(scene) else ""])
    return table(["scene", "photographs", "psfm: placed", "rightly", "parts", "COLMAP: placed", "rightly", "models",
                  ""], rows)


def _errors_table(result):
    rows = []
    for name, scene in result["scenes"].items():
        cells = []
        for program in ("psfm", "colmap"):
            cells += [significant(_aligned(scene, program, "median_of_extent"), " %"),
                      significant(_mean_error(scene, program)), number(_aligned(scene, program, "beyond"))]
        rows.append([name, scene["reference"], *cells])
    return table(["scene", "beside", "psfm: median", "mean [m]", "beyond 5 %", "COLMAP: median", "mean [m]",
                  "beyond 5 %"], rows, words=2)


def _cost_table(result):
    rows, ratios = [], []
    for name, scene in result["scenes"].items():
        ratios.append(ratio(scene["rounds"], "psfm", "processor_seconds"))
        rows.append([name, *(number(_middle(scene, program, "processor_seconds"), 1) for program in ("psfm", "colmap")),
                     number(ratios[-1], 3), *(number(_middle(scene, program, key), digits)
                                              for key, digits in (("seconds", 1), ("peak_mib", 0))
                                              for program in ("psfm", "colmap"))])
    rows.append(["**geometric mean**", "", "", f"**{number(geometric_mean(ratios), 3)}**", "", "", "", ""])
    return table(["scene", "psfm: processor [s]", "COLMAP", "ratio", "psfm: whole [s]", "COLMAP", "psfm: peak [MiB]",
                  "COLMAP"], rows)


def section(result):
    rounds = max((len(scene["rounds"]) for scene in result["scenes"].values()), default=0)
    fewer = [name for name, scene in result["scenes"].items() if _fewer(scene)]
    words = (f"COLMAP {result['colmap']}. "
             + (f"Medians of {rounds} rounds, counts of the worst. " if rounds > 1 else "One round. ")
             + ("COLMAP's part was kept from a run before. " if result["kept_colmap"] else "")
             + (f"psfm has fewer rightly placed than COLMAP in {', '.join(fewer)}." if fewer else
                "Nowhere has psfm fewer rightly placed than COLMAP."))
    return (f"{ABOUT}\n{paragraph(words)}\n{_placed_table(result)}\n{_errors_table(result)}\n{_cost_table(result)}")
