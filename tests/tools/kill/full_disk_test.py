#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""psfm on small real disks that become full, and on one that is read-only (tmpfs; needs root, else skipped).

usage: full_disk_test.py BUILD [POINTS]     (BUILD: build/release; POINTS: sizes of the disk, 20)
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77
IMAGES = 16
LARGE = "64m"


class Disk:
    def __init__(self, folder, size):
        self.folder = folder
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder], check=True, capture_output=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        subprocess.run(["umount", self.folder], check=True)

    def remount(self, options):
        subprocess.run(["mount", "-o", f"remount,{options}", self.folder], check=True)


class Test:
    def __init__(self, build, folder):
        self.build, self.folder = build, folder
        self.disk = folder / "disk"
        self.disk.mkdir()
        scene = folder / "scene"
        self.psfm("simulate", "--output", scene, "--scene", "courtyard", "--images", IMAGES)
        self.start = ["import", "--colmap-database", scene / "database.db", "--order", scene / "order.txt",
                      "--deterministic", "--log", folder / "log.jsonl", "--session"]
        self.expect(self.psfm(*self.start, folder / "undisturbed"), 0)
        self.records = self.dump(folder / "undisturbed")

    def psfm(self, *words):
        return subprocess.run([self.build / "psfm", *map(str, words)], capture_output=True, text=True)

    def dump(self, session):
        return subprocess.run([self.build / "tests/tools/kill/dump_session", session], capture_output=True, text=True,
                              check=True).stdout

    @staticmethod
    def expect(done, code, *texts):
        if done.returncode != code or any(text not in done.stderr for text in texts):
            sys.exit(f"{done.args}: exit code {done.returncode}, wanted {code} and {texts}: {done.stderr}")

    def acknowledged(self):
        events = map(json.loads, (self.folder / "log.jsonl").read_text().splitlines())
        return sum(event["event"] == "image" for event in events)

    def full(self, size):
        """Returns how many images had been acknowledged when the disk of that size was full."""
        session = self.disk / "session"
        (self.folder / "log.jsonl").write_text("")
        with Disk(self.disk, size) as disk:
            self.expect(self.psfm(*self.start, session), 1, "the disk is full; make space")
            acknowledged = self.acknowledged()
            disk.remount(f"size={LARGE}")
            if acknowledged:
                self.expect(self.psfm("check", "--session", session), 0)
                images = json.loads(self.psfm("status", "--session", session, "--json").stdout)["images"]
                if images < acknowledged:
                    sys.exit(f"{images} images are left of {acknowledged}")
            self.expect(self.psfm(*self.start, session), 0)
            if self.dump(session) != self.records:
                sys.exit(f"after a full disk of {size} bytes the session ends otherwise")
        return acknowledged

    def served(self):
        """The way on is the command that was stopped, and not `resume`, which would serve nobody."""
        session = self.disk / "session"
        with Disk(self.disk, "64k"):
            self.expect(self.psfm("serve", "--session", session, "--listen", "127.0.0.1:0"), 1,
                        f"the disk is full; make space, then run: psfm serve --session {session} --listen 127.0.0.1:0\n")

    def read_only(self):
        session = self.disk / "session"
        with Disk(self.disk, LARGE) as disk:
            self.expect(self.psfm(*self.start, session), 0)
            disk.remount("ro")
            self.expect(self.psfm("resume", "--session", session), 1, "Read-only file system")
            self.expect(self.psfm("status", "--session", session), 0)  # a reader writes elsewhere
            disk.remount("rw")
            self.expect(self.psfm("resume", "--session", session), 0)
            if self.dump(session) != self.records:
                sys.exit("after a read-only disk the session is another one")


def main():
    build, points = Path(sys.argv[1]).resolve(), int(sys.argv[2]) if len(sys.argv) > 2 else 20
    with tempfile.TemporaryDirectory(prefix="psfm-disk-") as temporary:
        folder = Path(temporary)
        try:
            with Disk(folder, LARGE):
                pass
        except (subprocess.CalledProcessError, FileNotFoundError):
            print("skipped: may not mount a file system here")
            return SKIPPED
        test = Test(build, folder)
        # What the session's records take is the least that it needs.
        needed = sum(int(line.split()[2]) for line in test.records.splitlines())
        acknowledged = [test.full(needed * point // points) for point in range(1, points + 1)]
        test.served()
        test.read_only()
        print(f"{points} disks of {needed // points} to {needed} bytes became full, after {acknowledged} images; "
              "nothing was lost")
        if max(acknowledged) < IMAGES // 2:
            sys.exit("the disks were too small to say much")
    return 0


if __name__ == "__main__":
    sys.exit(main())
