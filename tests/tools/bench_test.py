#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""tools/bench: figures are computed, programs watched and pages written as they should be. Nothing here tests time."""
import json
import sqlite3
import sys
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

TOOL = Path(__file__).resolve().parents[2] / "tools/bench"
sys.dont_write_bytecode = True
sys.path[:0] = [str(TOOL), str(TOOL.parent / "experiments")]

import arithmetic  # noqa: E402
import bench_settings  # noqa: E402
import console  # noqa: E402
import kernels  # noqa: E402
import matching  # noqa: E402
import over_session  # noqa: E402
import page  # noqa: E402
import parts  # noqa: E402
import peers  # noqa: E402
import simulated  # noqa: E402
import watched  # noqa: E402
from folder import Folder  # noqa: E402


class Arithmetic(unittest.TestCase):
    def test_median_and_percentile(self):
        self.assertEqual(arithmetic.median([5, 1, 3]), 3)
        self.assertEqual(arithmetic.median([4, 1, 3, 2]), 2.5)
        self.assertAlmostEqual(arithmetic.percentile(range(101), 0.95), 95)
        self.assertAlmostEqual(arithmetic.percentile([0, 10], 0.95), 9.5)
        self.assertEqual(arithmetic.percentile([7], 0.95), 7)
        self.assertIsNone(arithmetic.median([]))

    def test_windows_do_not_overlap(self):
        points = [(image, image) for image in range(1, 301)]
        self.assertEqual(arithmetic.within(points, 100, 200), list(range(101, 201)))
        parted = arithmetic.within(points, 0, 100) + arithmetic.within(points, 100, 300)
        self.assertEqual(parted, list(range(1, 301)))

    def test_quotients_of_nothing(self):
        self.assertEqual(arithmetic.quotient(6, 3), 2)
        self.assertIsNone(arithmetic.quotient(None, 3))
        self.assertIsNone(arithmetic.quotient(3, None))
        self.assertIsNone(arithmetic.quotient(3, 0))

    def test_moments_between_samples(self):
        samples = [(1.0, 0), (2.0, 10), (3.0, 10), (4.0, 20)]
        self.assertEqual(arithmetic.seconds_at(samples, 10), 2.0)
        self.assertEqual(arithmetic.seconds_at(samples, 5), 1.5)
        self.assertEqual(arithmetic.seconds_at(samples, 15), 3.5)
        self.assertIsNone(arithmetic.seconds_at(samples, 21))


    def test_amdahls_law_is_found_again(self):
        for serial in (0.0, 0.1, 0.5):
            times = {threads: 100 * (serial + (1 - serial) / threads) for threads in (1, 2, 4, 16)}
            self.assertAlmostEqual(arithmetic.amdahl_fit(times), serial)
            for threads, _, speed_up, efficiency, fraction in arithmetic.scaling_rows(times)[1:]:
                self.assertAlmostEqual(fraction, serial)
                self.assertAlmostEqual(efficiency, speed_up / threads)
                self.assertAlmostEqual(speed_up, times[1] / times[threads])

    def test_one_thread_says_nothing_about_more(self):
        self.assertIsNone(arithmetic.amdahl_fit({1: 10.0}))
        self.assertEqual(arithmetic.scaling_rows({1: 10.0}), [(1, 10.0, 1.0, 1.0, None)])

    def test_threads_double_up_to_the_machines(self):
        self.assertEqual(arithmetic.thread_counts(1), [1])
        self.assertEqual(arithmetic.thread_counts(2), [1, 2])
        self.assertEqual(arithmetic.thread_counts(6), [1, 2, 4, 6])
        self.assertEqual(arithmetic.thread_counts(16), [1, 2, 4, 8, 16])


    def test_the_geometric_mean(self):
        self.assertAlmostEqual(arithmetic.geometric_mean([0.1, 0.4]), 0.2)
        for values in ([], [0.1, None], [0.1, 0]):
            self.assertIsNone(arithmetic.geometric_mean(values))


class Provenance(unittest.TestCase):
    def test_no_folder_of_this_machine_is_written_down(self):
        words = ("tools/bench/run", "real", "--psfm", "/tmp/x/psfm", "--work=/tmp/w", "--scenes", "kermit",
                 "--datasets", "/data", "--output", "/tmp/o")
        self.assertEqual(bench_settings.named_command(words), "tools/bench/run real --psfm PSFM --work=WORK "
                         "--scenes kermit --datasets DIR --output OUT")


class Sessions(unittest.TestCase):
    def test_growth_is_that_of_the_asked_windows(self):
        points = [(image, 2.0 if image > 500 else 1.0) for image in range(1, 601)]
        self.assertEqual(over_session.growth(points), 2.0)
        self.assertIsNone(over_session.growth(points[:500]))

    def test_latencies_are_of_images_and_in_seconds(self):
        log = [{"event": "image", "index": 2, "latency_ms": 500.0}, {"event": "solve", "kind": "new"},
               {"event": "image", "index": 1, "latency_ms": 250.0}]
        self.assertEqual(over_session.latencies(log), [(1, 0.25), (2, 0.5)])

    def test_thinning_keeps_the_peak(self):
        samples = [(i / 5, i, 100.0 + (900.0 if i == 777 else 0.0)) for i in range(5000)]
        thin = over_session.thinned(samples)
        self.assertLess(len(thin), 500)
        self.assertIn((777 / 5, 777, 1000.0), thin)
        self.assertEqual(over_session.thinned(samples[:3]), samples[:3])

    def test_the_first_model(self):
        log = [{"event": "image", "index": index, "placed": placed, "latency_ms": 100.0 * index}
               for index, placed in ((1, 0), (4, 0), (5, 5), (6, 6))]
        self.assertEqual(over_session.first_model(log), (5, 0.5))
        self.assertIsNone(over_session.first_model(log[:2]))

    def test_tenths_of_a_simulated_session(self):
        times = [(1000, 1.0), (2000, 3.0), (3000, 9.0)]
        self.assertEqual(simulated.steps(times), [(1000, 1.0), (2000, 2.0), (3000, 6.0)])
        self.assertEqual(simulated.growth(times), 3.0)
        self.assertIsNone(simulated.growth([*times, (4000, None)]))


class Peers(Folder):
    def test_the_camera_that_all_share(self):
        cameras = self.folder / "cameras.txt"
        cameras.write_text("# comment\n1 PINHOLE 1536 1024 1379.74 1382.08 760.6 503.7\n"
                           "2 PINHOLE 1536 1024 1379.74 1382.08 760.6 503.7\n")
        self.assertEqual(peers.given_pinhole(self.folder), "1379.74,1382.08,760.6,503.7")
        cameras.write_text(cameras.read_text() + "3 PINHOLE 1536 1024 1400 1382.08 760.6 503.7\n")
        with self.assertRaises(console.Failed):
            peers.given_pinhole(self.folder)

    def test_ratios_are_taken_round_by_round(self):
        rounds = [{"psfm": {"seconds": ours}, "colmap": {"seconds": theirs}}
                  for ours, theirs in ((1, 10), (4, 20), (9, 30))]
        self.assertAlmostEqual(peers.ratio(rounds, "psfm", "seconds"), 0.2)  # of 0.1, 0.2, 0.3


def kernel_run(name, time, unit="ms", **more):
    return {"name": name, "run_name": name, "run_type": "iteration", "iterations": 10, "real_time": 9.0,
            "cpu_time": time, "time_unit": unit, **more}


class Kernels(unittest.TestCase):
    def test_medians_over_repetitions_in_seconds(self):
        read = kernels.read(json.dumps({"benchmarks": [
            kernel_run("BM_A", 3.0, edges=7.0), kernel_run("BM_A", 1.0, edges=7.0), kernel_run("BM_A", 2.0, edges=7.0),
            {**kernel_run("BM_A_mean", 2.0), "run_type": "aggregate"}, kernel_run("BM_B", 5.0, "us"),
            kernel_run("BM_C", 1.0, error_occurred=True, error_message="no AVX-512")]}))
        self.assertEqual(set(read), {"BM_A", "BM_B"})
        self.assertAlmostEqual(read["BM_A"]["seconds"], 0.002)
        self.assertEqual(read["BM_A"]["edges"], 7.0)
        self.assertAlmostEqual(read["BM_B"]["seconds"], 5e-6)

    def test_the_fraction_of_the_peak(self):
        measured = {kernels.KERNEL: {"MAC/s": 4e11}, kernels.PEAK: {"MAC/s": 5e11}}
        self.assertAlmostEqual(kernels.fraction_of_peak(measured), 0.8)
        self.assertIsNone(kernels.fraction_of_peak({kernels.KERNEL: {"MAC/s": 4e11}}))

    def test_every_kernel_is_built(self):
        listed = (TOOL.parents[1] / "tests/bench/CMakeLists.txt").read_text()
        for name in kernels.NAMES:
            self.assertIn(f"psfm_add_kernel({name} ", listed)


class Matching(Folder):
    def test_features_are_cut_to_a_number(self):
        database = self.folder / "database.db"
        connection = sqlite3.connect(database)
        with connection:
            for name, cols, size in (("keypoints", 6, 24), ("descriptors", 128, 128)):
                connection.execute(f"CREATE TABLE {name} (image_id INTEGER, rows INTEGER, cols INTEGER, data BLOB)")
                for image, rows in ((1, 5), (2, 2)):
                    data = b"".join(bytes([row]) * size for row in range(rows))
                    connection.execute(f"INSERT INTO {name} VALUES (?, ?, ?, ?)", (image, rows, cols, data))
        matching.keep_features(database, 3)
        for name, size in (("keypoints", 24), ("descriptors", 128)):
            rows = dict((image, (count, data)) for image, count, data in
                        connection.execute(f"SELECT image_id, rows, data FROM {name}"))
            self.assertEqual(rows[1], (3, b"".join(bytes([row]) * size for row in range(3))))
            self.assertEqual(rows[2][0], 2)
            self.assertEqual(len(rows[2][1]), 2 * size)
        connection.close()


class Watching(Folder):
    def test_images_and_memory_are_seen_while_a_program_runs(self):
        program = self.program("grows", """#!{python}
import json, sys, time
kept = bytearray(64 << 20)
with open(sys.argv[1], "w") as log:
    for index in (1, 2):
        print(json.dumps(dict(event="image", index=index)), file=log, flush=True)
    print(json.dumps(dict(event="solve")), file=log, flush=True)
    time.sleep(1.0)
    print(json.dumps(dict(event="image", index=3)), file=log)
""")
        run = watched.watch([program, self.folder / "log"], self.folder / "out.txt", self.folder / "log")
        self.assertIn(2, {images for _, images, _ in run.samples})
        self.assertEqual([entry["index"] for entry in run.of_event("image")], [1, 2, 3])
        self.assertGreater(run.peak_mib, 64)
        self.assertGreater(max(memory for _, _, memory in run.samples), 64)
        self.assertGreaterEqual(run.seconds, 1.0)

    def test_half_a_line_is_read_when_it_is_whole(self):
        log = self.folder / "log"
        log.write_text('{"event":"image"}\n{"event":')
        reader = watched.LogReader(log)
        reader.read()
        self.assertEqual(reader.images, 1)
        with log.open("a") as stream:
            stream.write('"image"}\n')
        reader.read()
        reader.close()
        self.assertEqual(reader.images, 2)

    def test_a_failure_names_program_and_last_words(self):
        program = self.program("fails", "#!{python}\nprint('no space'); raise SystemExit(3)\n")
        with self.assertRaisesRegex(console.Failed, "(?s)fails.*status 3.*no space"):
            watched.watch([program], self.folder / "out.txt")
        with self.assertRaisesRegex(console.Failed, "status 3"):
            watched.watch([program], self.folder / "out.txt", accept="no model")

    def test_an_answer_that_is_none_is_no_failure(self):
        program = self.program("finds nothing", "#!{python}\nprint('no model'); raise SystemExit(1)\n")
        self.assertGreater(watched.watch([program], self.folder / "out.txt", accept="no model").seconds, 0)


class Scratch(Folder):
    def test_the_files_of_others_are_never_removed(self):
        settings = bench_settings.Settings(None, None, self.folder)
        (self.folder / "mine").mkdir()
        with self.assertRaises(console.Failed):
            bench_settings.scratch(settings, "mine")
        ours = bench_settings.scratch(settings, "ours/part")
        (ours / "session").touch()
        self.assertFalse((bench_settings.scratch(settings, "ours/part") / "session").exists())


# What stands in for psfm: models from the third image on.
PSFM = """
if words[0] == "run":
    names = value("--order").read_text().split()
    value("--session").mkdir()
    value("--log").write_text("".join(json.dumps(dict(event="image", index=i + 1, latency_ms=250.0 + i,
        placed=(i + 1 if i >= 2 else 0))) + "\\n" for i in range(len(names))))
    threads = int(words[words.index("--threads") + 1]) if "--threads" in words else 1
    node = dict(node="solve", runs=2, busy_s=6.0, waiting_s=1.0, starved_s=3.0, work_s=9.0, queued_s=1.0)
    with value("--log").open("a") as log:
        print(json.dumps(dict(event="nodes", seconds=10.0, threads=threads, nodes=[node])), file=log)
elif words[0] == "status":
    print(json.dumps(dict(placed=4)))
elif words[0] == "evaluate":
    print(json.dumps(dict(models=[dict(registered=4, outliers=0, ate_mean=0.5, ate_rel=0.01)])))
else:
    sys.exit("unexpected: " + " ".join(words))
"""


class Command(Folder):
    def run_tool(self, *arguments, tool="run"):
        return self.run_program(TOOL / tool, *arguments)

    def install(self, scene):
        self.photographs(f"strecha-half/{scene}/images", 6)
        (self.folder / f"strecha-half/{scene}/gt").mkdir()
        return self.stand_in(PSFM)

    def test_list_and_usage(self):
        code, output, _ = self.run_tool("--list")
        self.assertEqual(code, 0)
        self.assertEqual([line.split()[0].rstrip(",") for line in output.splitlines()],
                         [part.name for part in parts.PARTS] + ["all"])
        for arguments in ((), ("no-such",), ("session", "--images", "1"), ("--list", "peers"),
                          ("peers", "--repeats", "0"), ("peers", "--threads", "0")):
            code, _, errors = self.run_tool(*arguments)
            self.assertEqual(code, 2, arguments)
            self.assertIn("usage:", errors)

    def test_what_is_missing_is_named_with_the_remedy(self):
        code, _, errors = self.run_tool("session", "--psfm", self.folder / "none")
        self.assertEqual(code, 1)
        self.assertIn("cmake --preset release", errors)
        psfm = self.install("castle-P19")
        code, _, errors = self.run_tool("session", "--scenes", "nowhere", "--psfm", psfm, "--work", self.folder / "work")
        self.assertEqual(code, 1)
        self.assertIn("castle-P19", errors)

    def test_a_result_and_its_page_are_written(self):
        psfm = self.install("castle-P19")
        output = self.folder / "docs"
        output.mkdir()
        (output / "performance.md").write_text(f"# By hand\n\n{page.MARKER}\nold figures\n")
        arguments = ("first-model", "latency", "--scenes", "castle-P19", "--images", "4", "--repeats", "3", "--psfm", psfm,
                     "--work", self.folder / "work", "--output", output)
        code, shown, errors = self.run_tool(*arguments)
        self.assertEqual(code, 0, errors)
        first = json.loads((output / "performance/first-model.json").read_text())
        self.assertEqual(first["result"]["castle-P19"]["images"], [3, 3, 3])
        for key in ("psfm", "machine", "date", "load", "command"):
            self.assertIn(key, first)
        written = (output / "performance.md").read_text()
        self.assertTrue(written.startswith("# By hand\n"))
        self.assertNotIn("old figures", written)
        self.assertIn("first-model latency --scenes castle-P19", written)
        self.assertIn("| castle-P19 | 3 | 0.25 |", written)
        self.assertIn("| castle-P19 | 3 | 0.25 |", shown)
        self.assertIn("(performance/session-castle-P19.svg)", written)
        ElementTree.parse(output / "performance/session-castle-P19.svg")
        self.assertEqual(list((self.folder / "work").rglob("session")), [self.folder / "work/session"])

        (output / "performance/session-castle-P19.svg").unlink()
        self.assertEqual(self.run_tool("--redraw", "--output", output)[0], 0)
        self.assertEqual((output / "performance.md").read_text(), written)
        self.assertTrue((output / "performance/session-castle-P19.svg").exists())

    def test_scaling_shows_speed_up_and_nodes(self):
        psfm = self.install("fountain-P11")
        code, shown, errors = self.run_tool("--scenes", "fountain-P11", "--threads", 3, "--repeats", 2, "--psfm", psfm,
                                            "--work", self.folder / "work", tool="scaling")
        self.assertEqual(code, 0, errors)
        record = json.loads((self.folder / "work/performance/scaling.json").read_text())
        runs = record["result"]["fountain-P11"]["runs"]
        self.assertEqual({threads: len(rounds) for threads, rounds in runs.items()}, {"1": 2, "3": 2})
        self.assertEqual(runs["3"][1]["nodes"]["threads"], 3)
        self.assertIn("| solve | 2 | 60 | 10 | 30 | 9.0 | 500 |", shown)
        self.assertIn("on 3 threads; busiest: solve", shown)
        self.assertIn("## Threads", (self.folder / "work/performance.md").read_text())
        ElementTree.parse(self.folder / "work/performance/scaling-fountain-P11.svg")
        self.assertEqual(self.run_tool("--threads", 0, tool="scaling")[0], 2)

    def test_a_trial_stays_out_of_the_documentation(self):
        psfm = self.install("fountain-P11")
        code, _, errors = self.run_tool("first-model", "--scenes", "fountain-P11", "--psfm", psfm, "--work",
                                        self.folder / "work")
        self.assertEqual(code, 0, errors)
        self.assertTrue((self.folder / "work/performance.md").exists())


if __name__ == "__main__":
    unittest.main()
