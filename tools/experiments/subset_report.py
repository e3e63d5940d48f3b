# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""The page of the random parts of scenes with look-alikes."""
from report import again, left_out, measured_when, number, page_of, paragraph, table

READING = """\
A subset is a folder with some of a scene's photographs, drawn with a seed. Its *model* is all that was placed of it, in
one part or several. Images *waiting as look-alikes* are not placed, and the reason is `look_alikes`; others may wait
for other reasons. *Wrong* images are outliers of `psfm evaluate` ([README.md](README.md)) against the reference of the
whole scene. Each part is aligned by itself, and counted whatever its size; of a part that cannot be aligned all images
are wrong. A model is *said* to be doubtful where `look_alikes` is among the reasons of `weak_models` in
`psfm status --json`. In default mode several images are worked on at once, so that another run may end differently.
"""


class Summary:
    """Of several subsets; those that failed count for nothing."""

    def __init__(self, subsets):
        done = [subset for subset in subsets if subset.record]
        self.models = [subset for subset in done if subset.placed]
        self.wrong_models = [subset for subset in self.models if subset.wrong]
        self.not_said = [subset for subset in self.wrong_models if not subset.is_said]
        self.right_said = [subset for subset in self.models if not subset.wrong and subset.is_said]
        self.counts = [len(done), sum(subset.placed for subset in done), sum(subset.waiting for subset in done),
                       sum(subset.wrong for subset in done), len(self.wrong_models), len(self.not_said),
                       len(self.right_said)]


def _of_scenes(subsets):
    """{scene: its subsets}"""
    scenes = {}
    for subset in subsets:
        scenes.setdefault(subset.run.source.name, []).append(subset)
    return scenes


def _summary_table(subsets):
    scenes = _of_scenes(subsets)
    if len(scenes) > 1:
        scenes["all"] = subsets
    rows = [[scene, *map(number, Summary(of_scene).counts)] for scene, of_scene in scenes.items()]
    return table(["scene", "subsets", "images placed", "images waiting as look-alikes", "wrong images",
                  "models with a wrong image", "of these not said", "right models that are said to be doubtful"], rows)


def _said(subset):
    if subset.is_said:
        return "yes"
    return "**no**" if subset.wrong else ""


def _details_table(subsets):
    rows = []
    for subset in subsets:
        _, count, seed = subset.run.order
        cells = ["failed", "", ""]
        if subset.record:
            cells = [f"{number(subset.placed)} / {number(subset.wrong)} / {number(subset.parts)}",
                     number(subset.waiting), _said(subset)]
        rows.append([subset.run.source.name, str(count), str(seed), *cells])
    return table(["scene", "photographs", "seed", "placed / wrong / parts", "waiting as look-alikes", "said"], rows)


def in_short(subsets):
    """One line for the overview."""
    parts = []
    for scene, of_scene in _of_scenes(subsets).items():
        summary = Summary(of_scene)
        parts.append(f"{scene}, {len(summary.wrong_models)} of {len(summary.models)} models have a wrong image, "
                     f"{len(summary.not_said)} of these not said to be doubtful")
    return "In short: " + "; ".join(parts) + "."


def write_subset_page(settings, experiment, subsets):
    records = [subset.record for subset in subsets if subset.record]
    parts = [f"# {experiment.title}\n", paragraph(experiment.about), left_out(settings), paragraph(in_short(subsets)),
             paragraph(measured_when(records) + ".") if records else "", "## How they end\n", paragraph(READING),
             _summary_table(subsets), "## Every subset\n",
             paragraph("Said: yes, the model is said to be doubtful; **no**, it is not, but has a wrong image."),
             _details_table(subsets), "## Commands\n",
             paragraph(f"All of it: `{again(settings, experiment)}`. A row is `psfm run FOLDER --session SESSION`, where "
                       "FOLDER has links to the photographs that Python's "
                       "`sorted(random.Random(f\"{seed}{N}\").sample(sorted_names, N))` draws, then "
                       "`psfm status --session SESSION --json` and `psfm evaluate --reference REFERENCE "
                       "--session SESSION --every-image --json`.")]
    file = settings.output / f"{experiment.name}.md"
    file.write_text(page_of(parts))
    return file
