# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tests of psfm serve have in common: a server on a session of its own, and photographs."""
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from server import API, Server

BUILD = Path(sys.argv[1]) if len(sys.argv) > 1 else Path()


def psfm(*words):
    done = subprocess.run([BUILD / "psfm", *map(str, words)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


class ServeCase(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.shared = Path(folder.name)
        subprocess.run([BUILD / "tests/synthetic/psfm-render-scene", cls.shared / "wall", "--scene", "wall", "--images", "6",
                        "--width", "400", "--height", "300", "--gps"], check=True, stdout=subprocess.DEVNULL)
        cls.photos = [file.read_bytes() for file in sorted((cls.shared / "wall/images").iterdir())]
        cls.finished = cls.shared / "finished"

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.session = Path(folder.name) / "session"
        self.server = None
        self.addCleanup(self.end)

    def end(self):
        if self.server and self.server.process.poll() is None:
            self.server.stop(signal.SIGKILL)

    def serve(self, *options, **keywords):
        self.server = Server(BUILD, self.session, *options, **keywords)
        return self.server

    def serve_finished(self, **keywords):
        """A session of its own in which all six photographs are placed; made by the first that asks."""
        if not self.finished.exists():
            server = self.serve()
            for i, photo in enumerate(self.photos):
                self.assertEqual(server.put(photo, f"IMG_{i}.jpg")[0], 201)
            self.wait_for(lambda: server.json("/session")["counts"]["placed"] == 6)
            self.assertEqual(server.stop(), 0)
            shutil.move(self.session, self.finished)
        shutil.copytree(self.finished, self.session)
        return self.serve(**keywords)

    def user(self, name, role="send", *options):
        code, out, err = psfm("serve", "--session", self.session, "--add-user", name, "--role", role, *options)
        self.assertEqual(code, 0, err)
        return re.search(r"#token=([\w-]+)", out).group(1)

    def wait_for(self, condition, seconds=120):
        end = time.time() + seconds
        while time.time() < end:
            if (found := condition()):
                return found
            time.sleep(0.2)
        self.fail("it did not come in time")
        return None

    def files(self):
        """What requests leave."""
        return sorted(path for name in ("photographs", "thumbnails", "uploads.log") for path in [*self.session.glob(name), *self.session.glob(f"{name}/**/*")])

    def events(self, seconds, last_id=None):
        """Kinds, ids and data of the stream's first events."""
        header = f"Last-Event-ID: {last_id}\r\n" if last_id else ""
        text = self.server.raw(f"GET {API}/events HTTP/1.1\r\nHost: {self.server.host}\r\n{header}\r\n".encode(), seconds)
        return re.findall(r"event: (\w+)\ndata: (.*)\nid: (\S+)\n", text.decode())

    def first_id(self):
        return re.sub(r"-\d+$", "-0", self.events(0.5)[0][2])
