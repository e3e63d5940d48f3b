# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""psfm serve and psfm view on ports of their own, for tests that speak with them."""
import hashlib
import http.client
import json
import os
import re
import signal
import socket
import subprocess
import tempfile
from pathlib import Path

API = "/api/v1"


class Server:
    """psfm serve on a port of its own."""

    def __init__(self, build, session, *options, command="serve", keep_free=1, listen="127.0.0.1:0",
                 said=None):
        """@param keep_free  of the disk [MiB]
        @param said  the file for what the server says on stderr; None: one of its own"""
        if command == "serve":
            options += ("--keep-free", str(keep_free))
        self.said = said or tempfile.TemporaryFile("w+")  # a pipe that nobody reads would hold the server up
        self.process = subprocess.Popen([build / "psfm", command, "--session", session, "--listen", listen, *options],
                                        stdout=subprocess.PIPE, stderr=self.said, text=True)
        line = self.process.stdout.readline()
        found = re.search(r":(\d+)/", line)
        if not found:
            self.stop(signal.SIGKILL)
            raise RuntimeError(f"psfm {command} said {line!r} and {self.errors!r}")
        self.port = int(found.group(1))
        self.host = f"127.0.0.1:{self.port}"

    def processor_seconds(self):
        """What the server has used so far, without its children."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def ask(self, method, path, body=None, token=None, **headers):
        """@return status, headers, body"""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        sent = {name.replace("_", "-"): value for name, value in headers.items()}
        if token:
            sent["Authorization"] = f"Bearer {token}"
        connection.request(method, path, body, sent)
        answer = connection.getresponse()
        data = answer.read()
        connection.close()
        return answer.status, answer.headers, data

    def json(self, path, token=None):
        status, _, body = self.ask("GET", API + path, token=token)
        assert status == 200, (path, status, body)
        return json.loads(body)

    def raw(self, data, seconds=30):
        """All that the server answers to these bytes."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=seconds) as connection:
            connection.sendall(data)
            answer = b""
            try:
                while chunk := connection.recv(65536):
                    answer += chunk
            except (socket.timeout, ConnectionResetError):
                pass
            return answer

    def put(self, data, name="a.jpg", token=None, **headers):
        return self.ask("PUT", f"{API}/photographs/{sha(data)}?name={name}", data, token, **headers)

    def patch(self, data, at, length, end=None, token=None):
        return self.ask("PATCH", f"{API}/photographs/{sha(data)}?name=a.jpg", data[at:end], token,
                        Upload_Offset=str(at), Upload_Length=str(length),
                        Content_Type="application/offset+octet-stream")

    def decoder_of(self, sha256):
        """The process that decodes this photograph for the server; None: none does at the moment."""
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                name = (folder / "comm").read_text().strip()
                words = (folder / "cmdline").read_bytes()
            except OSError:
                continue
            if b"decode-photograph" in words and name == sha256[:15]:
                return int(folder.name)
        return None

    def stop(self, how=signal.SIGTERM):
        self.process.send_signal(how)
        code = self.process.wait(60)
        self.process.stdout.close()
        self.said.seek(0)
        self.errors = self.said.read()
        self.said.close()
        return code


def sha(data):
    return hashlib.sha256(data).hexdigest()
