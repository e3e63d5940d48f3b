#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""`psfm status --json` is as its schema says, while a session runs and afterwards; `psfm report` tells the same.
Usage: status_and_report_test.py BUILD SCHEMA [TEST …]"""
import json
import re
import subprocess
import sys
import tempfile
import unittest
from html.parser import HTMLParser
from pathlib import Path

BUILD = Path()
SCHEMA = {}
TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "integer": int, "number": (int, float),
         "null": type(None)}


def violations(value, schema, path="$"):
    """Of the part of JSON Schema that docs/status.schema.json uses."""
    if "enum" in schema and value not in schema["enum"]:
        yield f"{path}: {value!r} is none of {schema['enum']}"
    if "type" in schema:
        types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        is_flag = isinstance(value, bool)
        if not any(isinstance(value, TYPES[name]) and (not is_flag or name == "boolean") for name in types):
            yield f"{path}: {value!r} is no {types}"
            return
    if "minimum" in schema and value < schema["minimum"]:
        yield f"{path}: {value} is too small"
    if isinstance(value, dict):
        yield from (f"{path}: lacks {name}" for name in schema.get("required", []) if name not in value)
        for name, field in value.items():
            if "properties" in schema and name not in schema["properties"]:
                yield f"{path}: {name} is not described"
            else:
                yield from violations(field, schema.get("properties", {}).get(name, {}), f"{path}.{name}")
    if isinstance(value, list):
        for i, item in enumerate(value):
            yield from violations(item, schema.get("items", {}), f"{path}[{i}]")


class Page(HTMLParser):
    """Elements of a page, and what they point to."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.targets = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.elements.append(tag)
        self.targets += [value for name, value in attrs if name in ("src", "href", "xlink:href", "action")]


class StatusAndReport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.session = cls.folder / "session"
        cls.run_psfm("simulate", "--scene", "courtyard", "--images", 40, "--output", cls.folder / "scene")
        cls.log = cls.folder / "log.jsonl"
        start = [BUILD / "psfm", "import", "--colmap-database", cls.folder / "scene/database.db", "--order",
                 cls.folder / "scene/order.txt", "--session", cls.session, "--log", cls.log,
                 "--set", "solve.assessment.weak_angle_deg=90"]  # so that its models are weak
        with subprocess.Popen(start, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as run:
            cls.during = []
            while run.poll() is None:
                done = subprocess.run([BUILD / "psfm", "status", "--session", cls.session, "--json"],
                                      capture_output=True, text=True, check=False)
                if done.returncode == 0:
                    cls.during.append(json.loads(done.stdout))
            assert run.returncode == 0, run.stderr.read()
        cls.status = json.loads(cls.run_psfm("status", "--session", cls.session, "--json"))

    @staticmethod
    def run_psfm(*words):
        done = subprocess.run([BUILD / "psfm", *map(str, words)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def test_status_is_as_the_schema_says(self):
        for status in [*self.during, self.status]:
            self.assertEqual(list(violations(status, SCHEMA)), [])

    def test_the_schema_is_read(self):
        broken = {**self.status, "placed": "many"}
        del broken["version"]
        self.assertEqual(len(list(violations(broken, SCHEMA))), 2)

    def test_every_image_is_listed_once(self):
        images = self.status["image_list"]
        names = (self.folder / "scene/order.txt").read_text().split()
        self.assertEqual(sorted(image["name"] for image in images), sorted(names))
        for state in ("placed", "waiting"):
            self.assertEqual(sum(image["state"] == state for image in images), self.status[state])
        for image in images:
            if image["state"] == "placed":
                self.assertGreater(image["inliers"], 10)
                self.assertLess(image["error_px"], 3.0)
                self.assertLessEqual(image["since"]["version"], self.status["version"])
                self.assertGreater(image["since"]["version"], 0)
            else:
                self.assertTrue(image["advice"])

    def test_who_runs_is_told_only_while_it_runs(self):
        self.assertIsNone(self.status["running"])
        self.assertFalse((self.session / "running.json").exists())
        running = [status["running"] for status in self.during if status["running"]]
        self.assertTrue(running)
        self.assertEqual({note["expected"] for note in running}, {40})

    def test_follow_ends_with_the_run(self):
        lines = self.run_psfm("status", "--session", self.session, "--follow").splitlines()
        self.assertEqual([json.loads(line) for line in lines], [self.status])

    def report(self, *options):
        page, figures = self.folder / "report.html", self.folder / "report.json"
        self.run_psfm("report", "--session", self.session, "--output", page, "--json", figures, *options)
        return page.read_text(), json.loads(figures.read_text())

    def test_report_needs_nothing_from_elsewhere(self):
        page = Page(self.report()[0])
        self.assertEqual(page.targets, [])
        self.assertNotIn("script", page.elements)
        self.assertGreater(page.elements.count("svg"), 5)

    def test_a_report_has_no_table_without_rows(self):
        scene, session, page = (self.folder / name for name in ("quiet_scene", "quiet", "quiet.html"))
        self.run_psfm("simulate", "--scene", "courtyard", "--images", 8, "--output", scene)
        self.run_psfm("import", "--colmap-database", scene / "database.db", "--session", session, "--deterministic")
        self.assertEqual(json.loads(self.run_psfm("status", "--session", session, "--json"))["events"], [])
        self.run_psfm("report", "--session", session, "--output", page)
        self.assertNotIn("</thead>\n</table>", page.read_text())
        self.assertIn("No event so far.", page.read_text())

    def test_report_tells_what_status_tells(self):
        page, figures = self.report("--log", self.log)
        for name in ("images", "placed", "waiting", "rejected", "version", "resets"):
            self.assertEqual(figures[name], self.status[name])
        self.assertEqual(figures["image_list"], self.status["image_list"])
        self.assertIn(f"{self.status['placed']} of {self.status['images']} accepted", page)
        for image in self.status["image_list"]:
            self.assertIn(image["name"], page)

    def test_report_doubts_the_models_that_status_doubts(self):
        words = [line for model in self.status["weak_models"] for line in model["words"]]
        self.assertTrue(words)
        page, figures = self.report()
        self.assertEqual(figures["weak_models"], self.status["weak_models"])
        told = self.run_psfm("status", "--session", self.session)
        for line in words:
            self.assertIn(f"<li>{line}</li>", page)
            self.assertIn(line, told)

    def test_report_counts_what_the_export_holds(self):
        self.run_psfm("export", "--session", self.session, "--format", "colmap-text", "--output", self.folder / "model")
        points, observations = 0, 0
        for part in (self.folder / "model").glob("*/points3D.txt"):
            for line in part.read_text().splitlines():
                if not line.startswith("#"):
                    points += 1
                    observations += (len(line.split()) - 8) // 2
        figures = self.report()[1]
        self.assertEqual((figures["points"], figures["observations"]), (points, observations))
        self.assertEqual(sum(figures["error_histogram"]["counts"]), observations)
        self.assertEqual(sum(figures["track_lengths"].values()), points)
        self.assertEqual(sum(cell["count"] for camera in figures["cameras"] for cell in camera["residual_cells"]),
                         observations)

    def test_report_knows_the_times_of_the_log(self):
        self.assertIsNone(self.report()[1]["times"])
        times = self.report("--log", self.log)[1]["times"]
        self.assertEqual(times["images"], 40)
        self.assertIn("verify", [node["node"] for node in times["nodes"]])

    def test_a_log_that_is_not_there_is_bad_input(self):
        done = subprocess.run([BUILD / "psfm", "report", "--session", self.session, "--output", self.folder / "no.html",
                               "--log", self.folder / "none"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 3)
        self.assertTrue(re.search("psfm run --log", done.stderr), done.stderr)
        self.assertFalse((self.folder / "no.html").exists())


if __name__ == "__main__":
    BUILD = Path(sys.argv[1])
    SCHEMA = json.loads(Path(sys.argv[2]).read_text())
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
