#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""psfm serve behind nginx, set up as docs/serve.md says.
Usage: proxy_test.py BUILD [TEST …]"""
import http.client
import json
import os
import re
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import time
import unittest
from pathlib import Path

from serve_case import ServeCase
from server import API, sha

SERVE_MD = Path(__file__).resolve().parents[3] / "docs/serve.md"
NAME = "photos.example.org"
NGINX = shutil.which("nginx") or shutil.which("nginx", path="/usr/sbin")


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@unittest.skipUnless(NGINX and shutil.which("openssl"), "there is no nginx")
class Proxy(ServeCase):
    def begin(self):
        """The server, and nginx before it."""
        self.token = self.user("Ada", "send", "--link", f"https://{NAME}")
        self.serve("--host", NAME)
        folder = self.session.parent
        subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={NAME}",
                        "-addext", f"subjectAltName=DNS:{NAME}", "-keyout", folder / "key", "-out", folder / "certificate"],
                       check=True, capture_output=True)
        self.port = free_port()
        block = re.search(r"^    server \{\n(?:    .*\n)*?    \}\n", SERVE_MD.read_text(), re.M).group(0)
        for said, here in (("listen 443 ssl", f"listen 127.0.0.1:{self.port} ssl"), ("127.0.0.1:8080", self.server.host),
                           ("/etc/ssl/certs/photos.pem", f"{folder}/certificate"),
                           ("/etc/ssl/private/photos.key", f"{folder}/key")):
            self.assertIn(said, block)
            block = block.replace(said, here)
        temporary = "".join(f"{kind}_temp_path {folder}/{kind};\n" for kind in ("client_body", "proxy", "fastcgi", "uwsgi", "scgi"))
        user = "user root;\n" if os.geteuid() == 0 else ""  # its folders are this user's alone
        (folder / "nginx.conf").write_text(f"{user}daemon off;\npid {folder}/pid;\nerror_log {folder}/errors;\nevents {{}}\n"
                                           f"http {{\naccess_log off;\n{temporary}{block}}}\n")
        nginx = subprocess.Popen([NGINX, "-p", folder, "-c", folder / "nginx.conf"], stderr=subprocess.PIPE, text=True)
        self.addCleanup(nginx.stderr.close)
        self.addCleanup(nginx.wait)
        self.addCleanup(nginx.send_signal, signal.SIGTERM)
        self.trust = ssl.create_default_context(cafile=folder / "certificate")

        def listens():
            self.assertIsNone(nginx.poll(), nginx.returncode is not None and nginx.stderr.read())
            with socket.socket() as one:
                return one.connect_ex(("127.0.0.1", self.port)) == 0
        self.wait_for(listens, 30)

    def ask(self, method, path, body=None, **headers):
        """Through the proxy. @return the answer, to be read"""
        raw = socket.create_connection(("127.0.0.1", self.port), timeout=60)
        connection = http.client.HTTPConnection(NAME)
        connection.sock = self.trust.wrap_socket(raw, server_hostname=NAME)
        self.addCleanup(connection.close)
        connection.request(method, path, body, {name.replace("_", "-"): value for name, value in headers.items()})
        return connection.getresponse()

    def test_the_document_s_example_serves(self):
        self.begin()
        origin = {"Origin": f"https://{NAME}"}
        answer = self.ask("POST", API + "/login", json.dumps({"token": self.token}), Content_Type="application/json", **origin)
        self.assertEqual(answer.status, 200)
        self.assertIn("; Secure", answer.headers["Set-Cookie"])
        cookie = {"Cookie": answer.headers["Set-Cookie"].split(";")[0]}

        stream = self.ask("GET", API + "/events", **cookie)
        self.assertEqual((stream.status, stream.headers["Content-Type"]), (200, "text/event-stream"))
        self.assertIn(b"hello", b"".join(stream.readline() for _ in range(3)))

        large = b"P6\n2000 700\n255\n" + os.urandom(2000 * 700 * 3)  # more than nginx takes by itself
        for data in (self.photos[0], large):
            answer = self.ask("PUT", f"{API}/photographs/{sha(data)}?name=a.jpg", data, **cookie, **origin)
            self.assertEqual(answer.status, 201)
        start = time.time()
        while (line := stream.readline()) and not line.startswith(b"event: image"):
            pass
        self.assertTrue(line)
        self.assertLess(time.time() - start, 60)  # at once, and not once a buffer is full
        self.assertEqual(self.ask("GET", API + "/session").status, 401)
        self.assertEqual(self.ask("GET", API + "/session", Host="evil.example", **cookie).status, 421)

    def test_a_quiet_stream_outlasts_the_proxy(self):
        timeout = int(re.search(r"proxy_read_timeout (\d+)s;", SERVE_MD.read_text()).group(1))
        header = (SERVE_MD.parents[1] / "tools/serve/http_server.h").read_text()
        self.assertLess(2 * float(re.search(r"heartbeat_seconds = ([\d.]+)", header).group(1)), timeout)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)  # so that what is skipped is told
