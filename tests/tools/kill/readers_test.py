#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""status, check and export over and over beside a psfm that writes, and a second writer that is refused.

usage: readers_test.py BUILD [IMAGES]     (BUILD: build/release; IMAGES: of the simulated scene, 40)
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path


def main():
    psfm, images = Path(sys.argv[1]).resolve() / "psfm", sys.argv[2] if len(sys.argv) > 2 else "40"
    with tempfile.TemporaryDirectory(prefix="psfm-readers-") as temporary:
        folder = Path(temporary)
        scene, session = folder / "scene", folder / "session"
        subprocess.run([psfm, "simulate", "--output", scene, "--scene", "courtyard", "--images", images], check=True,
                       stdout=subprocess.DEVNULL)
        start = [psfm, "import", "--colmap-database", scene / "database.db", "--order", scene / "order.txt",
                 "--session", session]
        writer = subprocess.Popen(start, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while not (session / "psfm-session").exists() and writer.poll() is None:
            pass
        commands = [["status", "--json"], ["check"], ["export", "--format", "ply", "--output", folder / "model"]]
        reads, seen, refused = 0, [0], 0
        while writer.poll() is None:
            for command in commands:
                done = subprocess.run([psfm, command[0], "--session", session, *command[1:]], capture_output=True,
                                      text=True)
                # Before the first model there is nothing to export; the message says so.
                if done.returncode != 0 and not (command[0] == "export" and done.returncode == 3):
                    sys.exit(f"{command[0]}: exit code {done.returncode}: {done.stdout} {done.stderr}")
                if command[0] == "status":
                    seen.append(json.loads(done.stdout)["images"])
                reads += 1
            second = subprocess.run(start, capture_output=True, text=True)
            if writer.poll() is None:
                refused += 1
                if second.returncode != 3 or f"in use by process {writer.pid}" not in second.stderr:
                    sys.exit(f"a second writer: exit code {second.returncode}: {second.stderr}")
        if writer.returncode != 0:
            sys.exit(f"the writer ended with exit code {writer.returncode}")
        if seen != sorted(seen):
            sys.exit(f"images seen: {seen}")
        print(f"{reads} reads beside the writer, {len(set(seen))} states of it; {refused} second writers refused")
    return 0


if __name__ == "__main__":
    sys.exit(main())
