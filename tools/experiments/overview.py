# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""docs/experiments/README.md: what is measured, how to repeat it, and the pages that exist."""
import re

from scenes import EXPERIMENTS

TEXT = """\
# Experiments

Does a reconstruction stay right while its images arrive in whatever order? These are the experiments of Locher,
Havlena and Van Gool, *Progressive Structure from Motion* (ECCV 2018), on scenes whose truth is known, with psfm and
with COLMAP fed the same matches in the same order.

{pages}
## What is measured

- **psfm, progressive**: `psfm run --deterministic` (or `psfm import`, where matches come from a database): each image
  goes through the whole graph before the next. The state after every image is kept, and judged by
  `psfm evaluate --every-image`.
- **COLMAP, continued**: the paper's baseline in progressive mode. `colmap mapper` reads the session's verified matches
  (`psfm export --format colmap-database`), and is continued from its own largest model (`--input_path`) with the images
  that have arrived after 20, 40, 60, 80 images, a third, a half, two thirds and all (quarters, up to 60 images).
- **batch**: both programs on all images at once, with the matches of the first order they came in.

| column | meaning |
|---|---|
| placed | images in a model |
| in the largest | of these in the largest effective cluster (COLMAP: model) |
| outliers | cameras whose centre is off by more than half the smallest distance between two cameras of the reference, summed over effective clusters (models) of at least five cameras, each aligned by itself |
| effective clusters | clusters that the pose graph joins into one frame count as one; COLMAP: models |
| clusters | clusters with a model |
| recoveries | resets: a model that was bad or stuck, or a few images of one, made anew |
| mean error, relative error | position error of the largest, in the reference's units; RMS error by the diagonal of the reference's bounding box |
| solving | psfm: all cluster solves and merges, added up; COLMAP: the mapper, all steps added up |
| whole | psfm from start to end; with extraction and matching where it began with photographs, and with all that is stored. A dash: the run was interrupted |

Under *work saved*: an image that arrives leaves most clusters as they were, and these are *skipped*; *coalesced* are
solves that several images shared; *extended* and *transferred* ones begin with what was there; *new* ones begin with
nothing; *settled* are the last adjustments once no image follows. A solve's time is its own: solves that run beside one
another are added up.

`orders`, the promise as a table, is none of the paper's: real scenes in many orders, in deterministic and in default
mode, and whether they all end alike.

`subsets` is none of the paper's either: a few photographs, drawn at random, of scenes with look-alikes. Often nothing
in them tells two alike things apart; what counts is how many images stand wrong, and that psfm says which models are
doubtful.

## Repeat

```
cmake --preset release && cmake --build --preset release
apt-get install colmap                               # optional
export PSFM_DATASETS=DIR                             # the folder with temple-341, quad-streams, duplicates, …
tools/experiments/run --list
tools/experiments/run temple-unfortunate             # or all
tools/experiments/run temple-shuffled --images 60    # the first 60 of each order, to try; writes into --work only
tools/experiments/run orders --scenes street         # a part of the table; also --orders, --modes
tools/experiments/run subsets --scenes street        # likewise; without --scenes, ten minutes
```

`--work` (`build/experiments`) keeps sessions, logs and COLMAP's models. What is there already is used again, so that a
page or plot is redrawn in seconds; an interrupted run goes on where it stopped. `--again` makes psfm's part anew.
`--share-matches` looks at the photographs once and gives the matches to every order, `--database FILE` takes them from
a COLMAP database; both save the time of matching, as the paper's experiments do. `--colmap-until N` continues COLMAP
up to N images only.
"""


def _line_of(page):
    found = re.search(r"^In short: (.*?)\n(?:\n|$)", page.read_text(), re.M | re.S)
    return " ".join(found[1].split()) if found else ""


def write_overview(output):
    rows = []
    for experiment in EXPERIMENTS:
        page = output / f"{experiment.name}.md"
        if page.exists():
            rows.append(f"| [{experiment.title}]({page.name}) | {_line_of(page)} |\n")
    pages = "| experiment | in short |\n|---|---|\n" + "".join(rows) if rows else ""
    file = output / "README.md"
    file.write_text(TEXT.replace("{pages}\n", pages + "\n" if pages else ""))
    return file
