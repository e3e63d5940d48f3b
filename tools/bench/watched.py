# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Programs are run and watched: seconds, processor time, memory, and how many images the log knows of meanwhile."""
import json
import os
import shlex
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

from console import Failed, tail_of

SAMPLE_SECONDS = 0.2


@dataclass
class Watched:
    seconds: float
    processor_seconds: float
    peak_mib: float                               # the kernel's own count, nothing is missed between samples
    samples: list = field(default_factory=list)   # (seconds, images in the log, resident MiB)
    log: list = field(default_factory=list)       # the lines of the log, as objects

    def of_event(self, kind):
        return [entry for entry in self.log if entry.get("event") == kind]

    def progress(self):
        return [(seconds, images) for seconds, images, _ in self.samples]

    def in_short(self):
        return {"seconds": round(self.seconds, 3), "processor_seconds": round(self.processor_seconds, 3),
                "peak_mib": round(self.peak_mib, 1)}


class LogReader:
    """Follows a file of JSON lines that is being written."""

    def __init__(self, file):
        self.file, self.entries, self.images = file, [], 0
        self._stream, self._rest = None, ""

    def read(self):
        if self._stream is None:
            if self.file is None or not self.file.exists():
                return
            self._stream = self.file.open(errors="replace")
        *lines, self._rest = (self._rest + self._stream.read()).split("\n")
        for line in lines:
            try:
                entry = json.loads(line)
            except json.JSONDecodeError as error:
                raise Failed(f"{self.file} has a line that is no JSON: {line[:80]}") from error
            self.entries.append(entry)
            self.images += entry.get("event") == "image"

    def close(self):
        if self._stream is not None:
            self._stream.close()


def resident_mib(pid):
    """Memory of a running process; None when it has just ended."""
    try:
        pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    except (OSError, IndexError):
        return None
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


def watch(command, output, log=None, accept=None):
    """Runs a program to its end. What it prints goes into the file `output`; a status other than 0 is a failure.

    @param log     the JSON lines that it writes, if it does
    @param accept  words with which it ends where a positive status is an answer, and no failure
    """
    command = [str(word) for word in command]
    output = Path(output)
    output.parent.mkdir(parents=True, exist_ok=True)
    reader, samples = LogReader(log), []
    with output.open("w") as file:
        file.write("$ " + shlex.join(command) + "\n")
        file.flush()
        started = time.monotonic()
        try:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT,
                                       env={**os.environ, "QT_QPA_PLATFORM": "offscreen"})
        except OSError as error:
            raise Failed(f"cannot start {command[0]}: {error.strerror}") from error
        pid, pause = 0, 0.01
        try:
            while True:
                pid, status, usage = os.wait4(process.pid, os.WNOHANG)
                seconds = time.monotonic() - started
                if pid:
                    break
                memory = resident_mib(process.pid)
                reader.read()
                if memory is not None:
                    samples.append((round(seconds, 3), reader.images, round(memory, 1)))
                time.sleep(pause)  # short programs are timed well, long ones hardly disturbed
                pause = min(SAMPLE_SECONDS, pause * 1.2)
        except KeyboardInterrupt:
            os.waitpid(process.pid, 0)  # Ctrl-C reaches it, too
            pid = process.pid
            raise
        finally:
            if pid:
                process.returncode = 0  # nobody is to wait for it again
    reader.read()
    reader.close()
    code = os.waitstatus_to_exitcode(status)
    if code < 0 or code > 0 and (accept is None or accept not in tail_of(output)):
        raise Failed(f"{shlex.join(command)}\nended with status {code}; {output} ends with\n{tail_of(output)}")
    return Watched(seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, samples, reader.entries)
