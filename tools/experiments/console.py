# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Programs are run and watched, and failures say what to do."""
import json
import os
import shlex
import subprocess
import sys
import time
from pathlib import Path

TAIL_LINES = 12


class Failed(Exception):
    """An experiment cannot go on; the message names the cause and the remedy."""


def say(text):
    print(text, file=sys.stderr, flush=True)


def tail_of(file):
    lines = Path(file).read_text(errors="replace").splitlines()
    return "\n".join("  | " + line for line in lines[-TAIL_LINES:])


def call(command, output, *, accept=(0,), env=None):
    """Runs a program to its end, with what it prints in the file `output`; seconds and exit status.

    Its own progress is seen where there is a terminal. A status that is not in `accept` is a failure;
    `accept=None` takes any.
    """
    command = [str(word) for word in command]
    output = Path(output)
    output.parent.mkdir(parents=True, exist_ok=True)
    started = time.monotonic()
    with output.open("w") as file:
        errors = None if sys.stderr.isatty() and Path(command[0]).name == "psfm" else subprocess.STDOUT
        file.write("$ " + shlex.join(command) + "\n")
        file.flush()
        try:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=errors,
                                       env={**os.environ, **(env or {})})
        except OSError as error:
            raise Failed(f"cannot start {command[0]}: {error.strerror}") from error
        try:
            status = process.wait()
        except KeyboardInterrupt:
            # Ctrl-C reaches the program, too: psfm finishes the commit that is under way.
            process.wait()
            raise
    if accept is not None and status not in accept:
        raise Failed(f"{shlex.join(command)}\nended with status {status}; {output} ends with\n{tail_of(output)}")
    return time.monotonic() - started, status


def answer(command, *, accept=(0,)):
    """What a short-lived program prints."""
    command = [str(word) for word in command]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    except OSError as error:
        raise Failed(f"cannot start {command[0]}: {error.strerror}") from error
    if accept is not None and done.returncode not in accept:
        raise Failed(f"{shlex.join(command)}\nended with status {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def answer_json(command, *, accept=(0,)):
    text = answer(command, accept=accept)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        if not text.strip() and accept is None:
            return None
        raise Failed(f"{shlex.join(str(word) for word in command)}\nprinted no JSON: {error}") from error


def machine():
    """The machine in words, for a table of times."""
    model = "an unknown processor"
    for line in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []:
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    return f"{os.cpu_count()} cores of {model}"


def load_average():
    """Programs that want to run, over the last minute: above 0, times suffer from others."""
    return round(os.getloadavg()[0], 1)
