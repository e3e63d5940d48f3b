#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Users who send photographs in pieces while many watch, and a server that is killed in the middle of it: every
acknowledged photograph is in the session exactly once, and every watcher has what a snapshot has.
usage: cluster_test.py BUILD [--photos FOLDER] [--users N] [--each N] [--watchers N] [--kills N] [--piece BYTES]
                       [--browser] [--keep FOLDER]
By hand: cluster_test.py build/release --photos QUAD_STREAMS/images --each 75 --watchers 50 --browser"""
import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from server import API, Server, sha

SKIPPED = 77  # of browser.cjs: there is no Chromium


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--photos", type=Path, help="folder; without it a wall is rendered")
    parser.add_argument("--users", type=int, default=8)
    parser.add_argument("--each", type=int, default=2, help="photographs of a user")
    parser.add_argument("--watchers", type=int, default=16)
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--piece", type=int, default=20000, help="bytes of a request")
    parser.add_argument("--browser", action="store_true", help="a page in Chromium watches, too; NODE_PATH as for viewer.live")
    parser.add_argument("--keep", type=Path, help="new folder: session, log and what the servers said stay there")
    return parser.parse_args()


def free_port():
    """Below those that clients are given: one that calls a dead server would get its port, and call itself."""
    port = 20000 + os.getpid() % 10000
    while True:
        with socket.socket() as free:
            try:
                free.bind(("127.0.0.1", port))
                return port
            except OSError:
                port += 1


def part(values, share):
    return round(values[min(len(values) - 1, int(share * len(values)))], 3) if values else None


def shown_by(page, end_server):
    """What an open page has to say at its end."""
    said = page.communicate()[0]
    if page.returncode == SKIPPED:
        print(said.strip())
        end_server()
        sys.exit(SKIPPED)
    return json.loads(said)


class Cluster:
    def __init__(self, asked, folder):
        self.asked = asked
        self.folder = folder
        self.session = folder / "session"
        self.port = free_port()
        self.log = folder / "log.jsonl"
        self.lock = threading.Lock()
        self.acknowledged = {}  # by hash: the user
        self.refusals = 0
        self.status_seconds = []
        self.committed = {}  # by version, and by the name of an image: when the engine said so
        self.over = False
        self.processor = 0.0

    def psfm(self, *words):
        done = subprocess.run([self.asked.build / "psfm", *map(str, words)], capture_output=True, text=True, check=True)
        return done.stdout

    def start(self):
        self.server = Server(self.asked.build, self.session, "--log", str(self.log), listen=f"127.0.0.1:{self.port}",
                             said=(self.folder / "said.txt").open("a+"))

    def end(self, how):
        before = os.times()
        code = self.server.stop(how)
        after = os.times()
        self.processor += after.children_user + after.children_system - before.children_user - before.children_system
        return code

    def photographs(self):
        """By user, in order: the users of a data set, or everyone's share of a wall."""
        users, each = self.asked.users, self.asked.each
        if self.asked.photos:
            files = sorted(self.asked.photos.iterdir())
            names = sorted({file.name.split("_")[0] for file in files})[:users]
            return [[file for file in files if file.name.startswith(name + "_")][:each] for name in names]
        subprocess.run([self.asked.build / "tests/synthetic/psfm-render-scene", self.folder / "wall", "--scene", "wall", "--images",
                        str(users * each), "--width", "400", "--height", "300"], check=True, stdout=subprocess.DEVNULL)
        files = sorted((self.folder / "wall/images").iterdir())
        return [files[i * each:(i + 1) * each] for i in range(users)]

    def send(self, user, token, files):
        """One user's photographs, each until it is acknowledged, over lines that break and servers that die."""
        for file in files:
            data = file.read_bytes()
            while not self.over:
                try:
                    status, headers, _ = self.server.ask("HEAD", f"{API}/photographs/{sha(data)}", token=token)
                    at = int(headers["Upload-Offset"]) if status == 200 else 0
                    if status == 200 and headers["Upload-Length"] == headers["Upload-Offset"]:
                        status = 201  # the answer was lost, the photograph was not
                    while status in (200, 204, 404):
                        status, headers, _ = self.server.patch(data, at, len(data), at + self.asked.piece, token)
                        if status == 204:
                            at = int(headers["Upload-Offset"])
                        elif status == 200:
                            status = 201
                    if status == 201:
                        with self.lock:
                            self.acknowledged[sha(data)] = user
                        break
                    with self.lock:
                        self.refusals += 1
                    time.sleep(min(2.0, float(headers["Retry-After"] or 0.2)))
                except OSError:
                    time.sleep(0.2)

    def ask_for_status(self, token):
        while not self.over:
            start = time.time()
            try:
                if self.server.ask("GET", API + "/session", token=token, Accept_Encoding="gzip")[0] == 200:
                    self.status_seconds.append(time.time() - start)
            except OSError:
                pass
            time.sleep(0.1)

    def follow_log(self):
        at = 0
        while not self.over:
            if self.log.exists():
                with self.log.open("rb") as log:
                    log.seek(at)
                    text = log.read()
                whole = text[:text.rfind(b"\n") + 1]
                at += len(whole)
                for line in whole.splitlines():
                    if b'"version":' in line:
                        said = json.loads(line)
                        self.committed.setdefault(said["version"], time.time())
                        self.committed.setdefault(said.get("name"), time.time())
            time.sleep(0.01)

    def run(self):
        asked = self.asked
        streams = self.photographs()
        total = sum(map(len, streams))
        tokens = [self.psfm("serve", "--session", self.session, "--add-user", f"user {i}").split("#token=")[1].split()[0]
                  for i in range(len(streams))]
        look = self.psfm("serve", "--session", self.session, "--add-user", "look", "--role", "look").split("#token=")[1].split()[0]
        began = time.time()
        self.start()
        watching = subprocess.Popen([asked.build / "tests/tools/serve/psfm-watch-server", str(self.port), str(asked.watchers), look],
                                    stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        page = self.open_page(look) if asked.browser else None
        threads = [threading.Thread(target=self.send, args=(i, tokens[i], stream)) for i, stream in enumerate(streams)]
        threads += [threading.Thread(target=self.ask_for_status, args=(look,)), threading.Thread(target=self.follow_log)]
        try:
            for thread in threads:
                thread.start()
            for kill in range(asked.kills):
                while len(self.acknowledged) < (kill + 1) * total // (asked.kills + 1):
                    time.sleep(0.02)
                self.end(signal.SIGKILL)
                self.start()
            for thread in threads[:len(streams)]:
                thread.join()
            self.wait_until_settled(total, look)
        finally:
            self.over = True
            for thread in threads:
                thread.join()
            shown = shown_by(page, lambda: self.end(signal.SIGTERM)) if page else None
            watched = json.loads(watching.communicate()[0])
            code = self.end(signal.SIGTERM) if self.server.process.poll() is None else None
        self.judge(total, watched, shown, code, time.time() - began)

    def open_page(self, token):
        script = Path(__file__).parent.parent / "viewer/follow.cjs"
        return subprocess.Popen(["node", script, self.asked.build, f"http://127.0.0.1:{self.port}/#token={token}"],
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def wait_until_settled(self, total, look):
        """All have come, and for six seconds neither counts change nor does the server do anything to speak of."""
        quiet, before, worked = 0, None, 0.0
        while quiet < 6:
            time.sleep(1)
            counts = self.server.json("/session", look)["counts"]
            seconds = self.server.processor_seconds()
            is_idle = counts == before and seconds - worked < 0.3
            quiet = quiet + 1 if is_idle and counts["images"] + counts["rejected"] >= total else 0
            before, worked = counts, seconds

    def delays(self, told):
        """How long after the engine's commit states and versions were told: median and 95th percentile [s]."""
        late = sorted(min(at for at, last in told["versions"] if last >= version) - when
                      for version, when in self.committed.items()
                      if isinstance(version, int) and any(last >= version for _, last in told["versions"]))
        states = sorted(at - self.committed[name] for name, at in told["images"].items() if name in self.committed)
        return {"states_after_seconds": {"median": part(states, 0.5), "p95": part(states, 0.95)},
                "versions_after_seconds": {"median": part(late, 0.5), "p95": part(late, 0.95)}}

    def judge(self, total, watched, shown, code, seconds):
        status = json.loads(self.psfm("status", "--session", self.session, "--json"))
        names = sorted(image["name"] for image in status["image_list"])
        self.psfm("export", "--session", self.session, "--format", "gltf", "--output", self.folder / "gltf")
        gltf = sum(file.stat().st_size for file in (self.folder / "gltf").rglob("*") if file.is_file())
        watchers = watched["watchers"]
        took = sorted(self.status_seconds)
        print(json.dumps({
            "photographs": total, "seconds": round(seconds, 1), "placed": status["placed"], "refusals": self.refusals,
            "parts": status["effective_clusters"],
            "server_processor_seconds": round(self.processor, 1), "status_requests": len(took),
            "status_seconds": {"median": part(took, 0.5), "p99": part(took, 0.99)}, **self.delays(watched),
            "browser": {**self.delays(shown), "listed": shown["listed"]} if shown else None,
            "watchers": len(watchers), "points": watchers[0]["points"], "changes": watchers[0]["changes"],
            "snapshots": watchers[0]["scenes"], "watcher_bytes": watchers[0]["bytes"], "gltf_bytes": gltf,
            "load": os.getloadavg()[0]}, indent=1))
        expected = sorted(f"{user + 1}/{sha256}.jpg" for sha256, user in self.acknowledged.items())
        assert len(self.acknowledged) == total, "not every photograph was acknowledged"
        assert names == expected, "the session has not exactly what was acknowledged"
        assert [one["difference"] for one in watchers] == [""] * self.asked.watchers, watchers
        assert all(one["points"] > 0 for one in watchers), "there is nothing to see"
        assert self.asked.kills == 0 or all(one["breaks"] > 0 for one in watchers), "the kills were not noticed"
        assert shown is None or (shown["difference"], shown["problems"], shown["listed"]) == ("", [], total), shown
        assert code == 0


def main():
    asked = arguments()
    if asked.keep:
        asked.keep.mkdir(parents=True)
        return Cluster(asked, asked.keep).run()
    with tempfile.TemporaryDirectory() as folder:
        Cluster(asked, Path(folder)).run()
    return None


if __name__ == "__main__":
    sys.exit(main())
