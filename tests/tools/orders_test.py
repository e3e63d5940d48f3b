#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/experiments/run orders: parts are counted, differing endings marked, and kept sessions used again."""
import shutil
import sys
import unittest
from pathlib import Path
from types import SimpleNamespace

TOOL = Path(__file__).resolve().parents[2] / "tools/experiments"
sys.dont_write_bytecode = True
sys.path.insert(0, str(TOOL))

import measurements  # noqa: E402
from folder import Folder  # noqa: E402
from order_table import Cell  # noqa: E402
from scenes import ORDERS  # noqa: E402

# What stands in for psfm. Where 3.jpg comes first and several images are in flight, the last one is left out; where
# 5.jpg comes first, the model is wrong. As many sit in a part too small to count.
PSFM = """
if words[0] == "run":
    names = value("--order").read_text().split()
    session = value("--session")
    session.mkdir()
    (session / "names").write_text(" ".join(names))
    (session / "mode").write_text("deterministic" if "--deterministic" in words else "default")
    value("--log").write_text("".join(json.dumps(dict(event="image", index=i + 1, name=name, clusters=1,
        effective_clusters=1, placed=i + 1, waiting=0, resets=0)) + "\\n" for i, name in enumerate(names)))
elif words[0] == "status":
    session = value("--session")
    names = (session / "names").read_text().split()
    lost = {sorted(names)[-1]} if names[0] == "3.jpg" and (session / "mode").read_text() == "default" else set()
    images = [dict(name=name, state="waiting" if name in lost else "placed", part=int(name in ("0.jpg", "1.jpg")))
              for name in names]
    print(json.dumps(dict(images=len(names), placed=len(names) - len(lost), waiting=len(lost), clusters=1,
        effective_clusters=1, resets=0, image_list=images)))
elif words[0] == "evaluate":
    names = (value("--session") / "names").read_text().split()
    wrong = 3 if names[0] == "5.jpg" else 0
    print(json.dumps(dict(models=[dict(registered=len(names), outliers=wrong, ate_mean=0.1)], versions=[
        dict(image=i + 1, placed=i + 1, effective_clusters=1, outliers=wrong if i > 3 else 0, largest=None)
        for i in range(len(names))])))
elif words[0] == "export":
    (value("--output") / "0").mkdir(parents=True)
    (value("--output") / "database.db").write_text("")
else:
    sys.exit("unexpected: " + " ".join(words))
"""


# Of eight photographs, beginning with 4.jpg, 5.jpg and 3.jpg.
SHUFFLES = ("shuffle-1", "shuffle-4", "shuffle-8")


def cell(parts, outliers=0):
    """@param parts  {name: part} of placed images"""
    images = [{"name": name, "state": "placed", "part": part} for name, part in parts.items()]
    images.append({"name": "waiting", "state": "waiting", "part": None})
    psfm = SimpleNamespace(status={"image_list": images}, rows=[measurements.Row(len(parts), outliers=outliers)])
    return Cell("scene", "names", "default", SimpleNamespace(psfm=psfm))


class Cells(unittest.TestCase):
    def test_small_parts_are_not_placed(self):
        found = cell({f"{part}-{i}": part for part, size in enumerate((6, 4, 9)) for i in range(size)})
        self.assertEqual(found.parts, [9, 6])
        self.assertEqual(len(found.placed), 15)
        self.assertNotIn("1-0", found.placed)

    def test_what_counts_as_another_end(self):
        seven = {f"a{i}": 0 for i in range(7)}
        self.assertFalse(cell(seven).differs_from(cell(seven)))
        self.assertFalse(cell(seven).differs_from(cell({name: 5 for name in seven})))  # numbers of parts are names
        self.assertTrue(cell(seven, outliers=1).differs_from(cell(seven)))
        self.assertTrue(cell(seven).differs_from(cell({**seven, "b": 0})))
        self.assertTrue(cell({f"{i}": i // 5 for i in range(10)}).differs_from(cell({f"{i}": 0 for i in range(10)})))
        self.assertTrue(Cell("scene", "names", "default").differs_from(cell(seven)))

    def test_all_that_was_ever_wrong(self):
        rows = [measurements.Row(i, outliers=outliers) for i, outliers in enumerate((None, 0, 2, 3, 1))]
        self.assertEqual(measurements.summed_outliers(rows), 6)
        self.assertEqual(measurements.most_outliers(rows, after=0), 3)
        self.assertIsNone(measurements.summed_outliers(rows[:1]))


class Command(Folder):
    def run_tool(self, *arguments):
        return self.run_program(TOOL / "run", *arguments)

    def install(self):
        for name in ("street", "books"):
            self.photographs(f"duplicates/{name}/images", 8)
            (self.folder / f"duplicates/{name}/reference").mkdir()
        self.photographs("kermit/images", 8)
        return self.stand_in(PSFM)

    def table(self, *arguments):
        """@return the page"""
        code, _, errors = self.run_tool("orders", "--psfm", self.install() if not self.written() else
                                        self.folder / "psfm", "--work", self.folder / "work", "--no-colmap", *arguments)
        self.assertEqual(code, 0, errors)
        return self.written().read_text()

    def written(self):
        page = self.folder / f"work/pages/{ORDERS.name}.md"
        return page if page.is_file() else None

    def test_usage(self):
        for arguments in (("orders", "--scenes", "nowhere"), ("orders", "--orders", "shuffle-11"), ("books", "--modes",
                          "default"), ("orders", "--modes", "both")):
            code, _, errors = self.run_tool(*arguments)
            self.assertEqual(code, 2, arguments)
            self.assertIn("usage:", errors)

    def test_rows_that_differ_are_marked(self):
        page = self.table("--scenes", "street", "kermit", "--orders", "names", "batch", *SHUFFLES)
        rows = [line for line in page.splitlines() if line.startswith(("| street", "| kermit"))]
        # Two of the eight stand in a part of two. Kermit is not shuffled with seed 8.
        self.assertEqual(rows[:4], [
            "| street | reference | 8 | 6 / 0 / 1 | 6 / 0 / 1 | 6 / 0 / 1 | 6 / 3 / 1 | 6 / 0 / 1 | **differs** |",
            "| kermit | psfm | 8 | 6 / 0 / 1 | 6 / 0 / 1 | 6 / 0 / 1 | 6 / 3 / 1 | – | **differs** |",
            "| street | reference | 8 | 6 / 0 / 1 | 6 / 0 / 1 | 6 / 0 / 1 | 6 / 3 / 1 | 5 / 0 / 1 | **differs** |",
            "| kermit | psfm | 8 | 6 / 0 / 1 | 6 / 0 / 1 | 6 / 0 / 1 | 6 / 3 / 1 | – | **differs** |"])
        self.assertIn("- street, seed 8, default: not placed: 7.jpg\n", page)
        self.assertIn("- street, seed 4, deterministic: 3 wrong\n", page)
        self.assertIn("in default mode 0 of 2 scenes end alike", page)
        again = page.partition("### In one-camera-default mode")[2].partition("###")[0]
        self.assertIn("| street |", again)
        self.assertNotIn("| kermit |", again)
        self.assertNotIn(str(self.folder), page)

    def test_the_way_is_of_scenes_with_a_reference(self):
        page = self.table("--scenes", "street", "kermit", "--modes", "deterministic")
        way = page.partition("## On the way")[2]
        self.assertIn("| street | shuffled, seed 5 |", way)
        self.assertNotIn("| kermit", way)

    def test_sessions_are_kept_and_the_rest_is_added(self):
        self.table("--scenes", "books", "--orders", "names", "--modes", "deterministic")
        made = {file: file.stat().st_mtime_ns for file in (self.folder / "work").rglob("names")}
        self.assertEqual(len(made), 1)
        page = self.table("--scenes", "books", "--orders", "names", "batch", "--modes", "deterministic")
        after = {file: file.stat().st_mtime_ns for file in (self.folder / "work").rglob("names")}
        self.assertEqual(len(after), 2)
        self.assertLessEqual(made.items(), after.items())
        self.assertIn("A part of the table only", page)
        self.assertIn(f"({ORDERS.name}.md)", (self.folder / "work/pages/README.md").read_text())

    def test_a_page_is_drawn_again_without_sessions(self):
        parts = ("--scenes", "kermit", "--orders", "names", "batch")
        page = self.table(*parts)
        for session in (self.folder / "work").rglob("session"):
            shutil.rmtree(session)
        self.assertEqual(self.table(*parts), page)


if __name__ == "__main__":
    unittest.main()
