# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""A session of thousands of simulated images: what an image costs when many are there already."""
import shutil

from arithmetic import quotient, seconds_at
from bench_settings import scratch, thread_options
from console import answer_json, say
from report import number, table
from svg_plot import Panel, Series, draw
from watched import watch

ABOUT = """\
`psfm simulate --scene streets` makes features and verified pairs of a town that grows with the number of images, and
`psfm import` takes them through the pipeline in an order of several users at once; no photograph is looked at.
"""
IMAGES = 10000


def measure(settings):
    images = settings.images or IMAGES
    folder = scratch(settings, "simulated")
    say(f"simulating {images} images …")
    watch([settings.psfm, "simulate", "--output", folder / "scene", "--scene", "streets", "--images", images],
          folder / "simulate.txt")
    say(f"importing {images} images …")
    log, session = folder / "log.jsonl", folder / "session"
    run = watch([settings.psfm, "import", "--colmap-database", folder / "scene/database.db", "--order",
                 folder / "scene/order.txt", "--session", session, "--log", log, *thread_options(settings)],
                folder / "psfm.txt", log)
    status = answer_json([settings.psfm, "status", "--session", session, "--json"])
    shutil.rmtree(folder)
    tenth = max(images // 10, 1)
    times = [(count, seconds_at(run.progress(), count)) for count in range(tenth, images + 1, tenth)]
    return {"images": images, "placed": status["placed"], **run.in_short(), "times": times}


def steps(times):
    """Seconds that each tenth of the images took: (last image, seconds)."""
    before, taken = 0.0, []
    for count, seconds in times:
        if seconds is None:
            break
        taken.append((count, seconds - before))
        before = seconds
    return taken


def growth(times):
    """Time of the last tenth / time of the second tenth; None when the session did not get that far."""
    taken = steps(times)
    return quotient(taken[-1][1], taken[1][1]) if len(taken) == len(times) >= 3 else None


def section(result):
    rows = [[number(count), number(seconds, 1)] for count, seconds in steps(result["times"])]
    tenth = result["times"][0][0]
    ratio = growth(result["times"])
    return (ABOUT + f"\n{number(result['images'])} images, {number(result['placed'])} placed, "
            f"{number(result['seconds'])} s in all, peak {number(result['peak_mib'])} MiB. Time of the last "
            f"{number(tenth)} / time of the second {number(tenth)}: **{number(ratio, 2)}**.\n\n"
            + table(["up to image", f"seconds for {number(tenth)}"], rows)
            + "\n![A simulated session](performance/simulated.svg)\n")


def plots(result):
    taken = steps(result["times"])
    panel = Panel(f"seconds for {result['times'][0][0]} images", [Series("psfm", taken, "#1f5fa8", kind="marks")])
    return {"simulated.svg": draw("A simulated session", f"{result['images']} images.", "images arrived",
                                  result["images"], [panel])}
