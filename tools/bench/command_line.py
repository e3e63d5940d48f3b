# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the commands of the benchmark have in common: options, and failures that say what to do."""
import os
from pathlib import Path

from bench_settings import Settings
from console import Failed, say

ROOT = Path(__file__).resolve().parents[2]


def add_common(parser):
    parser.add_argument("--scenes", nargs="+", default=(), metavar="SCENE", help="only these scenes (kernels)")
    parser.add_argument("--images", type=int, metavar="N", help="only the first N images")
    parser.add_argument("--repeats", type=int, default=1, metavar="N", help="rounds, of which medians are taken (1)")
    parser.add_argument("--datasets", type=Path, default=os.environ.get("PSFM_DATASETS"), metavar="DIR",
                        help="folder with strecha-half, quad-streams, duplicates ($PSFM_DATASETS)")
    parser.add_argument("--psfm", type=Path, default=ROOT / "build/release/psfm", metavar="FILE",
                        help="the program (build/release/psfm)")
    parser.add_argument("--work", type=Path, default=ROOT / "build/bench", metavar="DIR",
                        help="folder for sessions, which are removed again (build/bench)")
    parser.add_argument("--output", type=Path, metavar="DIR",
                        help="performance.md and performance/*.json, *.svg (docs; with --scenes or --images: --work)")


def check(parser, options, threads):
    """Refuses what makes no sense. @param threads  numbers of threads that were asked for"""
    if options.images is not None and options.images < 2:
        parser.error("--images wants at least 2")
    if options.repeats < 1:
        parser.error("--repeats wants at least 1")
    if min(threads, default=1) < 1:
        parser.error("--threads wants at least 1")


def absolute(path):
    return Path(os.path.abspath(path)) if path is not None else None


def output_of(options):
    trial = options.scenes or options.images
    return absolute(options.output) or (absolute(options.work) if trial else ROOT / "docs")


def settings_of(options, command, threads=None):
    psfm = absolute(options.psfm)
    if not psfm.is_file() or not os.access(psfm, os.X_OK):
        raise Failed(f"{psfm} is not there; build it (cmake --preset release && cmake --build --preset release), or "
                     "give --psfm FILE")
    return Settings(datasets=absolute(options.datasets), psfm=psfm, work=absolute(options.work),
                    scenes=tuple(options.scenes), images=options.images, repeats=options.repeats,
                    threads=threads, command=tuple(command),
                    kept_colmap=getattr(options, "kept_colmap", False))


def watched_main(main, arguments):
    """@return the exit code"""
    try:
        main(arguments)
    except Failed as failure:
        say(str(failure))
        return 1
    except OSError as error:
        say(f"{error}; is there space, and may files be written into --work and --output?")
        return 1
    except KeyboardInterrupt:
        say("\nstopped")
        return 1
    return 0
