#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/experiments: logs and models are read, steps planned, plots drawn and pages written as they should be."""
import json
import random
import re
import struct
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

TOOL = Path(__file__).resolve().parents[2] / "tools/experiments"
sys.dont_write_bytecode = True
sys.path.insert(0, str(TOOL))

import colmap_progressive  # noqa: E402
import console  # noqa: E402
import kept  # noqa: E402
import measurements  # noqa: E402
import orders  # noqa: E402
import scenes  # noqa: E402
import sources  # noqa: E402
import svg_plot  # noqa: E402
from folder import Folder  # noqa: E402

SVG = "{http://www.w3.org/2000/svg}"


def image_line(index, **counts):
    return json.dumps({"event": "image", "index": index, "name": f"{index}.jpg", "clusters": 1, "effective_clusters": 1,
                       "placed": index, "waiting": 0, "resets": 0, "latency_ms": 10.0,
                       "stages_ms": {"solve": 1.0, "merge": 0.5}, **counts})


def solve_line(kind, milliseconds):
    return json.dumps({"event": "solve", "text": "…", "clusters": [0], "kind": kind, "milliseconds": milliseconds})


class Log(unittest.TestCase):
    def test_images_solves_and_events(self):
        log = measurements.parse_log([
            image_line(1), solve_line("new", 100.0), image_line(2, placed=0), solve_line("extend", 20.0),
            json.dumps({"event": "reset", "text": "cluster 0 was reset"}), solve_line("new", 50.0), "",
            image_line(3, clusters=2, effective_clusters=1, resets=1), json.dumps({"event": "nodes", "nodes": []})])
        self.assertEqual([row.arrived for row in log.rows], [1, 2, 3])
        self.assertEqual((log.rows[2].clusters, log.rows[2].effective, log.rows[2].resets), (2, 1, 1))
        self.assertEqual(log.solves, {"new": [2, 150.0], "extend": [1, 20.0]})
        self.assertAlmostEqual(log.solve_ms, 170.0)
        self.assertAlmostEqual(log.merge_ms, 1.5)
        self.assertEqual(log.events, [(3, "reset", "cluster 0 was reset")])

    def test_the_later_line_counts(self):
        log = measurements.parse_log([image_line(2, placed=1), image_line(1), image_line(2, placed=2)])
        self.assertEqual([(row.arrived, row.placed) for row in log.rows], [(1, 1), (2, 2)])

    def test_an_event_after_the_last_image(self):
        log = measurements.parse_log([image_line(1), json.dumps({"event": "join", "text": "joined"})])
        self.assertEqual(log.events, [(1, "join", "joined")])

    def test_a_line_that_is_cut_short_is_named(self):
        with self.assertRaisesRegex(console.Failed, "log.jsonl line 2"):
            measurements.parse_log([image_line(1), image_line(2)[:20]], "log.jsonl")


class Versions(unittest.TestCase):
    def rows(self, count):
        return [measurements.Row(arrived) for arrived in range(1, count + 1)]

    def test_a_version_holds_until_the_next(self):
        largest = {"registered": 5, "outliers": 2, "ate_mean": 0.5}
        versions = [{"image": 2, "placed": 5, "effective_clusters": 1, "outliers": 2, "largest": largest},
                    {"image": 4, "placed": 0, "effective_clusters": 0, "outliers": 0, "largest": None}]
        rows = measurements.add_versions(self.rows(4), {"versions": versions})
        self.assertEqual([row.outliers for row in rows], [0, 2, 2, 0])
        self.assertEqual([row.largest for row in rows], [None, 5, 5, None])

    def test_a_log_and_versions_that_disagree_are_found(self):
        rows = self.rows(4)
        rows[1].placed = 5
        versions = [{"image": image, "placed": placed} for image, placed in ((1, 0), (2, 5), (3, 1), (4, 9))]
        self.assertEqual(measurements.disagreements(rows, {"versions": versions}), [(3, 0, 1)])
        self.assertEqual(measurements.disagreements(rows, None), [])

    def test_without_a_reference_nothing_is_said_of_outliers(self):
        rows = measurements.add_versions(self.rows(3), None)
        self.assertEqual([row.outliers for row in rows], [None] * 3)
        self.assertIsNone(measurements.most_outliers(rows, after=0))

    def test_the_last_row_is_the_finished_session(self):
        status = {"placed": 9, "clusters": 3, "effective_clusters": 2, "resets": 4}
        models = [{"registered": 6, "outliers": 1, "ate_mean": 0.1}, {"registered": 5, "outliers": 2, "ate_mean": 1.0},
                  {"registered": 4, "outliers": 4, "ate_mean": 1.0}]
        last = measurements.set_final(self.rows(2), status, {"models": models})[-1]
        self.assertEqual((last.placed, last.clusters, last.effective, last.resets), (9, 3, 2, 4))
        self.assertEqual((last.outliers, last.largest, last.largest_outliers), (3, 6, 1))  # four cameras are too few

    def test_from_when_on(self):
        rows = self.rows(6)
        for row, clusters in zip(rows, (1, 2, 1, 2, 1, 1), strict=True):
            row.clusters = clusters
        self.assertEqual(measurements.holds_from(rows, lambda row: row.clusters == 1), 5)
        self.assertIsNone(measurements.holds_from(rows, lambda row: row.clusters == 2))

    def test_milestones(self):
        measures = {key: measure for key, _, _, measure in measurements.MILESTONES}
        rows = [measurements.Row(arrived, placed=arrived, clusters=1, effective=1, outliers=0, largest=arrived,
                                 largest_outliers=0) for arrived in range(1, 101)]
        rows[29].outliers = rows[29].largest_outliers = 7
        rows[49].placed = rows[49].largest = 30
        self.assertEqual(measures["most_outliers"](rows), 7)
        self.assertEqual(measures["nearly_all_right"](rows), 51)
        self.assertEqual(measures["no_outlier_and_placed"](rows), 51)
        self.assertEqual(measures["one_effective"](rows), 1)

    def test_paper_figures_belong_to_milestones(self):
        keys = {key for key, _, _, _ in measurements.MILESTONES}
        for experiment in scenes.EXPERIMENTS:
            self.assertLessEqual(set(experiment.paper), keys)


class Orders(Folder):
    def test_steps(self):
        self.assertEqual(orders.step_plan(341), [20, 40, 60, 80, 114, 171, 228, 341])
        self.assertEqual(orders.step_plan(21), [6, 11, 16, 21])
        for count in range(2, 700):
            steps = orders.step_plan(count)
            self.assertEqual(steps, sorted(set(steps)))
            self.assertEqual(steps[-1], count)
            self.assertGreaterEqual(steps[0], 2)

    def test_colmap_until(self):
        def steps(until):
            return colmap_progressive.steps_of(sources.Settings(None, None, None, None, colmap_until=until), 341)

        self.assertEqual(steps(None), orders.step_plan(341))
        self.assertEqual(steps(114), [20, 40, 60, 80, 114])
        self.assertEqual(steps(5), [20])

    def test_mersenne_twister_is_that_of_the_standard(self):
        random = orders.Mt19937_64(5489)
        for _ in range(9999):
            random()
        self.assertEqual(random(), 9981545732273789042)  # ISO C++, [rand.predef]

    def test_shuffle_is_psfms(self):
        # The same example is worked out in tests/tools/commands/photo_order_test.cpp.
        self.assertEqual(orders.shuffled_names(["c", "a", "b"], 1), ["b", "a", "c"])

    def test_samples(self):
        names = [f"{i}.jpg" for i in range(10, 29)]
        self.assertEqual(orders.sampled_names(reversed(names), 8, 3), sorted(random.Random("38").sample(names, 8)))

    def test_order_files(self):
        names = ["b 1.jpg", "sub/a.jpg", "ä.jpg"]
        orders.write_order(self.folder / "order.txt", names)
        self.assertEqual(orders.read_order(self.folder / "order.txt"), names)


class ColmapModels(Folder):
    def write_model(self, folder, names):
        folder.mkdir(parents=True)
        data = struct.pack("<Q", len(names))
        for i, name in enumerate(names):
            data += struct.pack("<I7dI", i + 1, 1, 0, 0, 0, 0, 0, 0, 1) + name.encode() + b"\0"
            data += struct.pack("<Q", i) + struct.pack("<ddq", 1.5, 2.5, -1) * i
        (folder / "images.bin").write_bytes(data)

    def test_names(self):
        self.write_model(self.folder / "0", ["a.jpg", "sub/b.jpg", "c.jpg"])
        self.assertEqual(colmap_progressive.registered_names(self.folder / "0"), ["a.jpg", "sub/b.jpg", "c.jpg"])

    def test_the_largest_comes_first(self):
        self.write_model(self.folder / "0", ["a"])
        self.write_model(self.folder / "1", ["b", "c"])
        (self.folder / "2").mkdir()
        self.assertEqual(colmap_progressive.models_in(self.folder), [self.folder / "1", self.folder / "0"])

    def test_a_continued_model_has_no_sub_folder(self):
        self.write_model(self.folder / "models", ["a"])
        self.assertEqual(colmap_progressive.models_in(self.folder / "models"), [self.folder / "models"])

    def test_images_in_two_models_count_once(self):
        self.write_model(self.folder / "0", ["a", "b"])
        self.write_model(self.folder / "1", ["b", "c", "d"])
        judged = colmap_progressive.judge(None, colmap_progressive.models_in(self.folder), None)
        self.assertEqual((judged["placed"], judged["largest"], judged["models"]), (4, 3, 2))
        self.assertIsNone(judged["outliers"])


class KeptWork(Folder):
    def test_equal_settings_are_kept_and_others_are_not(self):
        first = kept.Kept(self.folder / "work", {"order": ("a", 1)})
        self.assertIsNone(first.record())
        first.begin()
        self.assertIsNone(first.record())
        self.assertTrue(first.is_begun())
        first.finish({"seconds": 3})
        self.assertEqual(kept.Kept(self.folder / "work", {"order": ("a", 1)}).record(), {"seconds": 3})
        self.assertIsNone(kept.Kept(self.folder / "work", {"order": ("a", 2)}).record())

    def test_the_files_of_others_are_never_removed(self):
        (self.folder / "work").mkdir()
        (self.folder / "work/thesis.txt").write_text("five years")
        with self.assertRaises(console.Failed):
            kept.Kept(self.folder / "work", {}).begin()
        self.assertTrue((self.folder / "work/thesis.txt").exists())


class Plots(unittest.TestCase):
    def draw(self, *panels):
        return ElementTree.fromstring(svg_plot.draw("a < b & c", "…", "images arrived", 40, list(panels)))

    def test_every_series_is_drawn_and_named(self):
        points = [(1, 0), (2, None), (3, 4), (4, 5)]
        root = self.draw(svg_plot.Panel("upper", [svg_plot.Series("the line", points, "#111111"),
                                                  svg_plot.Series("the marks", points, "#222222", kind="marks")]),
                         svg_plot.Panel("lower", [svg_plot.Series("the steps", points, "#333333", kind="steps"),
                                                  svg_plot.Series("the ticks", [(3, 0)], "#444444", kind="ticks")]))
        groups = {group.find(f"{SVG}title").text: group for group in root.iter(f"{SVG}g")
                  if group.get("class") == "series"}
        self.assertEqual(set(groups), {"the line", "the marks", "the steps", "the ticks"})
        texts = [text.text for text in root.iter(f"{SVG}text")]
        for name in (*groups, "upper", "lower", "images arrived", "a < b & c"):
            self.assertIn(name, texts)
        self.assertEqual(len(groups["the line"].findall(f"{SVG}path")), 2)  # a gap where nothing is known
        self.assertEqual(len(groups["the marks"].findall(f"{SVG}circle")), 3)
        self.assertIn("H", groups["the steps"].findall(f"{SVG}path")[1].get("d"))
        self.assertEqual(groups["the ticks"].find(f"{SVG}path").get("fill"), "#444444")

    def test_values_are_where_they_belong(self):
        root = self.draw(svg_plot.Panel("", [svg_plot.Series("s", [(0, 0), (40, 10)], "#111111")], height=100))
        group = next(group for group in root.iter(f"{SVG}g") if group.get("class") == "series")
        numbers = [float(word) for word in re.findall(r"[\d.]+", group.find(f"{SVG}path").get("d"))]
        self.assertEqual(numbers, [svg_plot.LEFT, svg_plot.TOP + 100, svg_plot.WIDTH - svg_plot.RIGHT, svg_plot.TOP])

    def test_ticks(self):
        self.assertEqual(svg_plot.nice_ticks(341), [0, 100, 200, 300, 400])
        self.assertEqual(svg_plot.nice_ticks(2), [0, 1, 2])
        for high in range(2000):
            ticks = svg_plot.nice_ticks(high)
            self.assertGreaterEqual(ticks[-1], high)
            self.assertLessEqual(len(ticks), 6)


# What stands in for psfm: it makes a session of the images in the order file, with a model of all of them.
PSFM = """
if words[0] == "run":
    count = len(value("--order").read_text().split())
    value("--session").mkdir()
    (value("--session") / "count").write_text(str(count))
    value("--log").write_text("".join(json.dumps(dict(event="image", index=i + 1, name="", clusters=1,
        effective_clusters=1, placed=i + 1, waiting=0, resets=0)) + "\\n" for i in range(count)))
elif words[0] == "import":
    value("--session").mkdir()
    (value("--session") / "count").write_text("2")
    value("--log").write_text("")
elif words[0] == "export":
    (value("--output") / "database.db").write_text("")
elif words[0] == "status":
    count = int((value("--session") / "count").read_text())
    print(json.dumps(dict(images=count, placed=count, waiting=0, rejected=0, clusters=1, effective_clusters=1,
        resets=0, solves_new=1)))
elif words[0] == "evaluate":
    count = int((value("--session") / "count").read_text())
    largest = dict(registered=count, outliers=1, ate_mean=0.1)
    print(json.dumps(dict(models=[largest], versions=[dict(image=i + 1, placed=i + 1, effective_clusters=1, outliers=1,
        largest=largest) for i in range(count)])))
else:
    sys.exit("unexpected: " + " ".join(words))
"""

# Eight photographs: two wait, and what is wrong is not said. Eleven: nothing is wrong, and one part is said to be
# doubtful. Fourteen: two parts, of which one is wrong and one cannot be aligned, and both are said to be doubtful.
PSFM_OF_SUBSETS = """
def count(): return int((value("--session") / "count").read_text())
if words[0] == "run":
    names = value("--order").read_text().split()
    assert sorted(file.name for file in Path(words[1]).iterdir() if file.is_file()) == names
    assert "--deterministic" not in words
    value("--session").mkdir()
    (value("--session") / "count").write_text(str(len(names)))
    value("--log").write_text("")
elif words[0] == "status":
    waiting = {0: "look_alikes", 1: "no_seed"} if count() == 8 else {}
    images = [dict(name=str(i), state="waiting" if i in waiting else "placed", reason=waiting.get(i, "placed"),
                   part=None if i in waiting else int(count() == 14 and i < 5)) for i in range(count())]
    weak = [dict(cluster=0, images=count(), reasons=["few_points"] + (["look_alikes"] if count() > 8 else []))]
    print(json.dumps(dict(placed=count() - len(waiting), image_list=images, weak_models=weak)))
elif words[0] == "evaluate":
    models = {8: [(6, 2)], 11: [(11, 0)], 14: [(9, 3), (5, None)]}[count()]
    print(json.dumps(dict(models=[dict(registered=images, outliers=wrong) for images, wrong in models])))
else:
    sys.exit("unexpected: " + " ".join(words))
"""


class Command(Folder):
    def run_tool(self, *arguments):
        return self.run_program(TOOL / "run", *arguments)

    def install(self):
        self.photographs("duplicates/cereal/images", 8)
        (self.folder / "duplicates/cereal/reference").mkdir()
        return self.stand_in(PSFM)

    def test_list(self):
        code, output, _ = self.run_tool("--list")
        self.assertEqual(code, 0)
        self.assertEqual([line.split()[0] for line in output.splitlines()],
                         [experiment.name for experiment in scenes.EXPERIMENTS] + ["all"])

    def test_usage(self):
        for arguments in ((), ("no-such",), ("books", "--images", "1"), ("--list", "books"), ("books", "--nonsense")):
            code, _, errors = self.run_tool(*arguments)
            self.assertEqual(code, 2, arguments)
            self.assertIn("usage:", errors)

    def test_what_is_missing_is_named_with_the_remedy(self):
        code, _, errors = self.run_tool("books", "--psfm", self.folder / "none")
        self.assertEqual(code, 1)
        self.assertIn("cmake --preset release", errors)
        psfm = self.install()
        code, _, errors = self.run_tool("books", "--psfm", psfm, "--work", self.folder / "work", "--no-colmap")
        self.assertEqual(code, 1)
        self.assertIn("PSFM_DATASETS", errors)

    def test_a_page_is_written_and_work_is_kept(self):
        psfm = self.install()
        arguments = ("cereal", "--psfm", psfm, "--work", self.folder / "work", "--output", self.folder / "pages",
                     "--no-colmap")
        code, _, errors = self.run_tool(*arguments)
        self.assertEqual(code, 0, errors)
        page = (self.folder / "pages/cereal.md").read_text()
        self.assertIn("psfm placed 8 of 8 (1 outlier", page)
        self.assertIn("(cereal.md)", (self.folder / "pages/README.md").read_text())
        self.assertNotIn(str(self.folder), page)
        self.assertEqual([line for line in page.splitlines() if len(line) > 120 and not line.startswith("|")], [])
        plots = sorted((self.folder / "pages").glob("*.svg"))
        self.assertEqual(len(plots), 3)
        for plot in plots:
            ElementTree.parse(plot)
            self.assertIn(f"({plot.name})", page)

        sessions = self.folder / "work/cereal"
        made = {file: file.stat().st_mtime_ns for file in sessions.rglob("count")}
        self.assertEqual(self.run_tool(*arguments)[0], 0)
        self.assertEqual({file: file.stat().st_mtime_ns for file in sessions.rglob("count")}, made)
        self.assertEqual(self.run_tool(*arguments, "--again")[0], 0)
        self.assertNotEqual({file: file.stat().st_mtime_ns for file in sessions.rglob("count")}, made)

    def test_a_trial_stays_out_of_the_documentation(self):
        psfm = self.install()
        code, _, errors = self.run_tool("cereal", "--psfm", psfm, "--work", self.folder / "work", "--images", "4",
                                        "--no-colmap")
        self.assertEqual(code, 0, errors)
        self.assertIn("psfm placed 4 of 4", (self.folder / "work/pages/cereal.md").read_text())

    def test_subsets(self):
        self.photographs("duplicates/street/images", 15)
        (self.folder / "duplicates/street/reference").mkdir()
        arguments = ("subsets", "--psfm", self.stand_in(PSFM_OF_SUBSETS), "--work", self.folder / "work")
        code, _, errors = self.run_tool(*arguments, "--scenes", "street")
        self.assertEqual(code, 0, errors)
        page = (self.folder / "work/pages/subsets.md").read_text()
        for row in ("| street | 18 | 186 | 6 | 60 | 12 | 6 | 6 |", "| street | 8 | 1 | 6 / 2 / 1 | 1 | **no** |",
                    "| street | 11 | 6 | 11 / 0 / 1 | 0 | yes |", "| street | 14 | 2 | 14 / 8 / 2 | 0 | yes |"):
            self.assertIn(row + "\n", page)
        self.assertIn("A part of the table only", page)
        self.assertNotIn("COLMAP", page)
        self.assertNotIn(str(self.folder), page)
        self.assertIn("(subsets.md)", (self.folder / "work/pages/README.md").read_text())

        for wrong, status, named in ((("--images", "4"), 1, "--images"), (("--scenes", "kermit"), 2, "scene kermit"),
                                     (("--modes", "default"), 2, "--modes is of `orders` alone")):
            code, _, errors = self.run_tool(*arguments, *wrong)
            self.assertEqual(code, status, errors)
            self.assertIn(named, errors)


if __name__ == "__main__":
    unittest.main()
