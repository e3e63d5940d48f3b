#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photographs on their way into psfm serve, from clients that are not ours: curl, and one that speaks tus.
Usage: uploads_test.py BUILD [TEST …]"""
import base64
import gzip
import http.client
import json
import re
import shutil
import signal
import subprocess
import sys
import unittest
from pathlib import Path

from serve_case import ServeCase, psfm
from server import API, sha

SERVE_MD = Path(__file__).resolve().parents[3] / "docs/serve.md"
TUS = {"Tus-Resumable": "1.0.0"}


class TusClient:
    """Sends as tus 1.0.0 has it, in pieces; knows nothing but the address of the upload."""

    def __init__(self, host, url, token):
        self.host, self.url, self.headers = host, url, {**TUS, "Authorization": f"Bearer {token}"}

    def ask(self, method, body=None, **headers):
        connection = http.client.HTTPConnection(self.host, timeout=60)
        connection.request(method, self.url, body, {**self.headers, **{k.replace("_", "-"): v for k, v in headers.items()}})
        answer = connection.getresponse()
        answer.read()
        connection.close()
        assert answer.headers["Tus-Resumable"] == "1.0.0", (method, answer.status)
        return answer

    def offset(self):
        answer = self.ask("HEAD")
        return int(answer.headers["Upload-Offset"]) if answer.status == 200 else None

    def send(self, data, piece, most_pieces=None):
        """From where it broke off. @return the last status"""
        at, status = self.offset(), None
        announced = {"Upload_Length": str(len(data))} if at is None else {}
        at = at or 0
        while at < len(data) and most_pieces != 0:
            answer = self.ask("PATCH", data[at:at + piece], Upload_Offset=str(at),
                              Content_Type="application/offset+octet-stream", **announced)
            status, at = answer.status, int(answer.headers["Upload-Offset"])
            announced = {}
            most_pieces = most_pieces and most_pieces - 1
        return status


class Uploads(ServeCase):
    def url(self, data):
        return f"{API}/photographs/{sha(data)}"

    def patch(self, data, at, end=None, length=None, token=None, **more):
        if length is not None:
            more["Upload_Length"] = str(length)
        return self.server.ask("PATCH", self.url(data), data[at:end], token, Upload_Offset=str(at),
                               Content_Type="application/offset+octet-stream", **more)

    def names(self, token):
        return sorted(image.get("title", image["name"]) for image in self.server.json("/session", token)["image_list"])

    def thumbnail(self, image, token):
        answer = self.server.ask("GET", f"{API}/images/{image}/thumbnail", token=token)
        return answer[0], answer[-1]

    def remove(self, data, token):
        return self.server.ask("DELETE", self.url(data), token=token)[0]

    def test_who_sent_a_photograph_takes_it_back(self):
        tokens = {name: self.user(name, role) for name, role in
                  [("Ada", "send"), ("Bob", "send"), ("Lou", "look"), ("Own", "owner")]}
        self.serve()
        for i, data in enumerate(self.photos):
            self.assertEqual(self.server.put(data, f"{i}.jpg", tokens["Ada"])[0], 201)
        self.wait_for(lambda: self.server.json("/session", tokens["Ada"])["counts"]["placed"] == 6)
        first, second, last = self.photos[0], self.photos[1], self.photos[5]
        self.assertEqual(self.server.put(second, "again.jpg", tokens["Bob"])[0], 200)
        self.assertEqual(self.remove(first, tokens["Bob"]), 404, "it is not his")
        self.assertEqual(self.remove(first, tokens["Lou"]), 403)
        thumbnails = [self.thumbnail(i, tokens["Ada"]) for i in range(6)]
        self.assertEqual([code for code, _ in thumbnails], 6 * [200])
        before = len(self.files())
        self.assertEqual(self.remove(first, tokens["Ada"]), 204)
        self.assertEqual(len(self.files()), before - 2, "the photograph and its thumbnail are gone at once")
        self.assertEqual(self.remove(first, tokens["Ada"]), 404)
        self.wait_for(lambda: self.names(tokens["Ada"]) == [f"{i}.jpg" for i in range(1, 6)])
        self.wait_for(lambda: self.server.json("/session", tokens["Ada"])["counts"]["placed"] == 5)
        self.assertEqual([self.thumbnail(i, tokens["Ada"]) for i in range(1, 6)], thumbnails[1:], "each has its own")
        self.assertEqual(self.thumbnail(0, tokens["Ada"])[0], 404)
        # Bob has sent it, too: it stays, and is his.
        self.assertEqual(self.remove(second, tokens["Ada"]), 204)
        self.wait_for(lambda: self.names(tokens["Ada"]) == ["2.jpg", "3.jpg", "4.jpg", "5.jpg", "again.jpg"])
        self.assertEqual(self.remove(last, tokens["Own"]), 204)
        self.wait_for(lambda: self.names(tokens["Ada"]) == ["2.jpg", "3.jpg", "4.jpg", "again.jpg"])
        # It may come in again, and all that holds for the next server.
        self.assertEqual(self.server.put(first, "anew.jpg", tokens["Ada"])[0], 201)
        self.wait_for(lambda: "anew.jpg" in self.names(tokens["Ada"]))
        self.assertEqual(self.server.stop(signal.SIGKILL), -signal.SIGKILL)
        self.serve()
        self.wait_for(lambda: self.names(tokens["Ada"]) == ["2.jpg", "3.jpg", "4.jpg", "again.jpg", "anew.jpg"])
        self.assertEqual(self.server.put(last, "last.jpg", tokens["Bob"])[0], 201)
        self.assertEqual(self.server.stop(), 0)

    def test_a_photograph_is_called_what_its_sender_called_it(self):
        server = self.serve_finished()
        server.stop()
        code, out, err = psfm("status", "--session", self.session, "--json")
        self.assertEqual(code, 0, err)
        images = json.loads(out)["image_list"]
        self.assertEqual([image["title"] for image in images], [f"IMG_{i}.jpg" for i in range(6)])
        self.assertEqual({image["sha256"] for image in images}, {sha(photo) for photo in self.photos})
        for command in ("report", "view"):
            page = self.session.parent / f"{command}.html"
            code, _, err = psfm(command, "--session", self.session, "--output", page)
            if command == "view" and "without pages" in err:
                continue
            self.assertEqual(code, 0, err)
            text = page.read_text()
            if command == "view":
                packed = re.search(r'id="session">([^<]+)<', text).group(1)
                text = gzip.decompress(base64.b64decode(packed)).decode()
            self.assertTrue("IMG_3.jpg" in text, command)

    def test_a_removal_outlives_a_server_that_dies_at_once(self):
        token = self.user("Ada")
        self.serve()
        for i, data in enumerate(self.photos[:3]):
            self.assertEqual(self.server.put(data, f"{i}.jpg", token)[0], 201)
        self.wait_for(lambda: len(self.names(token)) == 3)
        self.assertEqual(self.remove(self.photos[0], token), 204)
        self.server.stop(signal.SIGKILL)
        self.serve()
        self.wait_for(lambda: self.names(token) == ["1.jpg", "2.jpg"])
        for data in self.photos[1:3]:  # down to none
            self.assertEqual(self.remove(data, token), 204)
        self.wait_for(lambda: self.names(token) == [])
        self.assertEqual(self.server.put(self.photos[0], "0.jpg", token)[0], 201)
        self.wait_for(lambda: self.names(token) == ["0.jpg"])

    def test_a_client_of_tus_goes_on(self):
        token = self.user("Ada")
        self.serve()
        data = self.photos[0]
        client = TusClient(self.server.host, self.url(data), token)
        self.assertEqual(client.send(data, 3000, most_pieces=2), 204)
        self.server.stop(signal.SIGKILL)
        self.serve()
        client.host = self.server.host
        answer = client.ask("HEAD")
        self.assertEqual((answer.headers["Upload-Offset"], answer.headers["Upload-Length"]), ("6000", str(len(data))))
        self.assertEqual(client.send(data, 5000), 201)
        self.assertEqual(client.offset(), len(data))
        answer = client.ask("PATCH", b"", Upload_Offset="0", Content_Type="application/offset+octet-stream")
        self.assertEqual((answer.status, answer.headers["Upload-Offset"]), (200, str(len(data))))

    def test_every_answer_of_uploads_speaks_tus(self):
        self.user("Ada")
        server = self.serve()
        data = self.photos[0]
        for method, path, status, more in (("HEAD", self.url(data), 401, {}), ("PUT", self.url(data), 401, {}),
                                           ("PUT", self.url(data), 421, {"Host": "evil.example"}),
                                           ("GET", API + "/photographs", 401, {})):
            answer = server.ask(method, path, **more)
            self.assertEqual((answer[0], answer[1]["Tus-Resumable"]), (status, "1.0.0"))
        self.assertNotIn("Tus-Resumable", server.ask("GET", API + "/session")[1])

    def test_bytes_have_one_place(self):
        server = self.serve()
        data = self.photos[0]
        self.assertEqual(self.patch(data, 0, 1000)[0], 400)  # a length is wanted once
        self.assertEqual(self.patch(data, 0, 1000, len(data))[0], 204)
        for at in (0, 500, 1001):
            status, headers, _ = self.patch(b"x" * 999 + data, at)  # by another name: nothing has begun
            self.assertEqual(status, 400 if at == 0 else 409)
            status, headers, _ = server.ask("PATCH", self.url(data), b"x" * 100, Upload_Offset=str(at),
                                            Content_Type="application/offset+octet-stream")
            self.assertEqual((status, headers["Upload-Offset"]), (409, "1000"), at)
        self.assertEqual(self.patch(data, 1000, 2000, len(data) + 1)[0], 409)
        self.assertEqual(self.patch(data, 1000)[0], 201)
        self.assertEqual(server.ask("PUT", f"{API}/photographs/{sha(b'')}", b"")[0], 422)

    def test_the_quota_has_no_way_round(self):
        self.serve("--quota", "1")
        for k in range(3):
            data = bytes([k]) * 700_000
            self.assertEqual(self.patch(data, 0, 20_000, len(data))[0], 507 if k else 204)
            for at in ("0", "20000"):  # a small length for what was announced as a large one
                status = self.server.ask("PATCH", self.url(data), b"", Upload_Offset=at, Upload_Length="1",
                                         Content_Type="application/offset+octet-stream")[0]
                self.assertEqual(status, 409 if k == 0 or at != "0" else 204)

    def test_who_sends_it_too_has_it_in_his_list(self):
        first, second = self.user("First"), self.user("Second")
        self.serve()
        data = self.photos[0]

        def names(token):
            return [one["name"] for one in self.server.json("/photographs", token)["photographs"]]
        self.assertEqual(self.server.put(data, "mine.jpg", first)[0], 201)
        self.assertEqual(self.server.ask("HEAD", self.url(data), token=second)[0], 404)
        self.assertEqual(self.patch(data, 0, 1000, len(data), second)[0], 200)
        for _ in range(2):
            self.assertEqual(self.server.put(data, "hers.jpg", second)[0], 200)
            self.assertEqual(self.server.ask("HEAD", self.url(data), token=second)[0], 200)
            self.assertEqual((names(first), len(names(second))), (["mine.jpg"], 1))
            self.server.stop(signal.SIGKILL)
            self.serve()
        self.wait_for(lambda: self.server.json("/session", first)["image_list"])
        self.assertEqual([image["title"] for image in self.server.json("/session", first)["image_list"]], ["mine.jpg"])

    def test_titles_are_one_line_of_text(self):
        self.serve()
        names = ("a%E2%80%AEgpj.exe.jpg", "%E2%81%A6b%E2%81%A9%C2%85%E2%80%A8.jpg", "", "%20%E2%80%AE", "%C3%A4%FF.jpg")
        for name, photo in zip(names, self.photos):
            self.assertEqual(self.server.put(photo, name)[0], 201)
        self.assertEqual([one["name"] for one in self.server.json("/photographs")["photographs"]],
                         ["agpj.exe.jpg", "b.jpg", sha(self.photos[2])[:12], sha(self.photos[3])[:12], "ä.jpg"])

    @unittest.skipUnless(shutil.which("curl"), "there is no curl")
    def test_curl_sends_as_the_document_says(self):
        server = self.serve()
        file = self.session.parent / "a.jpg"
        file.write_bytes(self.photos[0])
        text = SERVE_MD.read_text()
        self.assertEqual(self.patch(self.photos[1], 0, 5000, len(self.photos[1]))[0], 204)  # and breaks off
        for photo, first in ((self.photos[0], "sum="), (self.photos[1], "url=")):
            file.write_bytes(photo)
            script = "set -e\nsum=$(sha256sum a.jpg | cut -c1-64)\n"
            script += re.search(rf"^    {first}.*\n(?:    .*\n)*", text, re.M).group(0).replace("127.0.0.1:8080", server.host)
            done = subprocess.run(["bash", "-c", script], cwd=file.parent, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual({one["sha256"] for one in server.json("/photographs")["photographs"]},
                         {sha(photo) for photo in self.photos[:2]})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)  # so that what is skipped is told
