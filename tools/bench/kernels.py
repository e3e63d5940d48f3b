# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Kernels: the Google Benchmark programs of tests/bench."""
import json

from arithmetic import median, quotient
from bench_settings import scratch
from console import Failed, say
from report import number, paragraph, significant, table
from watched import watch

ABOUT = """\
Google Benchmark, one thread each; processor time of one call, so that other programs on the machine disturb little.
Counters are the benchmarks' own.
"""
NAMES = ("extraction", "match_descriptors", "verification", "retrieval", "retrieval_index", "clustering",
         "rotation_averaging", "triangulation", "bundle_adjustment", "sim3", "merge")
PEAK, KERNEL = "BM_PeakVpdpbusd", "BM_Match/avx512_vnni/8000"
IN_SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
KNOWN_KEYS = {"name", "family_index", "per_family_instance_index", "run_name", "run_type", "repetitions",
              "repetition_index", "threads", "iterations", "real_time", "cpu_time", "time_unit", "error_occurred",
              "error_message", "label"}


def read(text):
    """{benchmark: {"seconds": processor time of a call, counter: value}}, medians over repetitions."""
    runs = {}
    for entry in json.loads(text)["benchmarks"]:
        if entry.get("error_occurred") or entry.get("run_type", "iteration") != "iteration":
            continue
        values = {"seconds": entry["cpu_time"] * IN_SECONDS[entry["time_unit"]]}
        values.update({key: value for key, value in entry.items() if key not in KNOWN_KEYS})
        runs.setdefault(entry["run_name"], []).append(values)
    return {name: {key: median([run[key] for run in repeated]) for key in repeated[0]}
            for name, repeated in runs.items()}


def fraction_of_peak(kernels):
    """Multiply-adds of the matching kernel by those of a loop that touches registers only, same instruction and run."""
    return quotient(kernels.get(KERNEL, {}).get("MAC/s"), kernels.get(PEAK, {}).get("MAC/s"))


def measure(settings):
    folder = scratch(settings, "kernels")
    programs = settings.psfm.parent / "tests/bench"
    result = {}
    names = settings.scenes or NAMES
    for name in names:
        program = programs / f"{name}_bench"
        if name not in NAMES or not program.is_file():
            raise Failed(f"{program} is not there; kernels are {', '.join(NAMES)}, built where Google Benchmark is "
                         "(apt-get install libbenchmark-dev)")
        say(f"{name} …")
        answer = folder / f"{name}.json"
        watch([program, f"--benchmark_repetitions={settings.repeats}", f"--benchmark_out={answer}",
               "--benchmark_out_format=json"], folder / f"{name}.txt")
        result[name] = read(answer.read_text())
    return result


def milliseconds(seconds):
    return significant(1000 * seconds)


def section(result):
    rows = []
    for name, kernels in result.items():
        for kernel, values in kernels.items():
            counters = ", ".join(f"{key} {significant(value)}" for key, value in values.items() if key != "seconds")
            rows.append([name, f"`{kernel}`", counters, milliseconds(values["seconds"])])
    fraction = fraction_of_peak(result.get("match_descriptors", {}))
    words = "\n" + paragraph(f"The matching kernel does **{number(fraction, 2)}** of the multiply-adds of a "
                             "register-only loop of the same instruction, in the same run.") if fraction else ""
    return ABOUT + words + "\n" + table(["program", "kernel", "counters", "ms"], rows, words=3)
