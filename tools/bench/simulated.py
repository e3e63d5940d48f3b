# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""A session of thousands of simulated images: what an image costs when many are there already."""
import shutil

from arithmetic import quotient, seconds_at
from bench_settings import scratch, thread_options
from console import answer_json, say
from report import item, number, table
from svg_plot import Panel, Series, draw
from watched import watch

ABOUT = """\
`psfm simulate --scene streets` makes features and verified pairs of a town that grows with the number of images, and
`psfm import` takes them through the pipeline, in two orders; no photograph is looked at. *Several users at once*
(order.txt) walk all over the town, again and again: of 10,000 images the last thousand have 2.7 times as many pairs
with earlier ones as the second thousand have. *District by district* (districts.txt) the session grows, and what an
image overlaps does not.
"""
IMAGES = 10000
ORDERS = {"order": "several users at once", "districts": "district by district"}


def measure(settings):
    images = settings.images or IMAGES
    folder = scratch(settings, "simulated")
    say(f"simulating {images} images …")
    watch([settings.psfm, "simulate", "--output", folder / "scene", "--scene", "streets", "--images", images],
          folder / "simulate.txt")
    result = {"images": images}
    for order, name in ORDERS.items():
        result[order] = measure_order(settings, images, folder, order, name)
    shutil.rmtree(folder)
    return result


def measure_order(settings, images, folder, order, name):
    say(f"importing {images} images, {name} …")
    log, session = folder / f"{order}.jsonl", folder / order
    run = watch([settings.psfm, "import", "--colmap-database", folder / "scene/database.db", "--order",
                 folder / f"scene/{order}.txt", "--session", session, "--log", log, *thread_options(settings)],
                folder / f"{order}-output.txt", log)
    status = answer_json([settings.psfm, "status", "--session", session, "--json"])
    tenth = max(images // 10, 1)
    times = [(count, seconds_at(run.progress(), count)) for count in range(tenth, images + 1, tenth)]
    return {"placed": status["placed"], **run.in_short(), "times": times}


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
    tenth = result["order"]["times"][0][0]
    lines = [item(f"{name}: {number(of['placed'])} of {number(result['images'])} placed, {number(of['seconds'])} s with"
                  f" settling, peak {number(of['peak_mib'])} MiB; time of the last {number(tenth)} / time of the second"
                  f" {number(tenth)}: **{number(growth(of['times']), 2)}**")
             for order, name in ORDERS.items() for of in [result[order]]]
    taken = [dict(steps(result[order]["times"])) for order in ORDERS]
    rows = [[number(count), *(number(of.get(count), 1) for of in taken)] for count, _ in result["order"]["times"]]
    return (ABOUT + "\n" + "".join(lines) + "\n"
            + table(["up to image", *(f"seconds for {number(tenth)}, {name}" for name in ORDERS.values())], rows)
            + "\n![A simulated session](performance/simulated.svg)\n")


def plots(result):
    colours = ("#1f5fa8", "#b5541c")
    series = [Series(name, steps(result[order]["times"]), colour, kind="marks")
              for (order, name), colour in zip(ORDERS.items(), colours)]
    panel = Panel(f"seconds for {result['order']['times'][0][0]} images", series)
    return {"simulated.svg": draw("A simulated session", f"{result['images']} images.", "images arrived",
                                  result["images"], [panel])}
