#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""psfm serve as its clients see it: honest ones, broken ones and hostile ones. What docs/serve.md promises.
Usage: api_test.py BUILD OPENAPI [TEST …]"""
import json
import os
import re
import signal
import socket
import sys
import time
import unittest
from pathlib import Path

from serve_case import ServeCase, psfm
from server import API, sha

OPENAPI = Path()


def at_place(photo, metres):
    """A photograph of psfm-render-scene, its position so far east of a place in Zurich."""
    out = bytearray(photo)
    places = re.finditer(rb"(?<=\x01\0\0\0.{4}\x01\0\0\0).{4}\x40\x42\x0f\0", photo, re.S)  # degrees, minutes, millionths
    for place, seconds in zip(places, (30.0, 20.0 + metres / 20.9), strict=True):
        out[place.start():place.start() + 4] = int(seconds * 1e6).to_bytes(4, "little")
    return bytes(out)


class Api(ServeCase):
    def test_photographs_become_a_model(self):
        server = self.serve()
        for i, photo in enumerate(self.photos):
            self.assertEqual(server.put(photo, f"IMG_{i}.jpg")[0], 201)
        self.wait_for(lambda: server.json("/session")["counts"]["placed"] == 6)
        session = server.json("/session")
        self.assertEqual([image["title"] for image in session["image_list"]], [f"IMG_{i}.jpg" for i in range(6)])
        scene = server.ask("GET", API + "/scene")[2]
        self.assertEqual(scene[:4], b"PSC1")
        mine = server.json("/photographs")["photographs"]
        self.assertEqual({one["state"] for one in mine}, {"placed"})
        detail = server.json("/images/0")["observations"]
        self.assertGreater(len(detail), 20)
        point = detail[0]
        self.assertIn(0, server.json(f"/points/{point['cluster']}/{point['slot']}")["images"])
        self.assertGreater(len(server.json("/pairs/0/1")["matches"]), 20)
        status, headers, picture = server.ask("GET", API + "/images/0/thumbnail")
        self.assertEqual((status, headers["Content-Type"], picture[:2]), (200, "image/jpeg", b"\xff\xd8"))
        self.assertNotIn(b"Exif", picture)
        kinds = [kind for kind, _, _ in self.events(1, last_id=self.first_id())]
        self.assertIn("image", kinds)
        self.assertIn("version", kinds)
        self.assertEqual(server.stop(), 0)
        status = json.loads(psfm("status", "--session", self.session, "--json")[1])
        self.assertEqual((status["images"], status["placed"]), (6, 6))

    def test_uploads_survive_kills_exactly_once(self):
        tries = 0
        server = self.serve()
        for photo in self.photos:
            third = len(photo) // 3
            self.assertEqual(server.patch(photo, 0, len(photo), third)[0], 204)
            if tries < 3:
                server.stop(signal.SIGKILL)
                server = self.serve()
                tries += 1
            status, headers, _ = server.ask("HEAD", f"{API}/photographs/{sha(photo)}")
            at = int(headers["Upload-Offset"]) if status == 200 else 0
            self.assertEqual(at, third)
            self.assertEqual(server.patch(photo, at + 1, len(photo))[0], 409)
            self.assertEqual(server.patch(photo, at, len(photo))[0], 201)
            self.assertEqual(server.put(photo)[0], 200)
        self.wait_for(lambda: server.json("/session")["counts"]["images"] == 6)
        server.stop()
        status = json.loads(psfm("status", "--session", self.session, "--json")[1])
        self.assertEqual(sorted(Path(image["name"]).stem for image in status["image_list"]),
                         sorted(sha(photo) for photo in self.photos))

    def test_what_is_no_photograph_is_refused(self):
        server = self.serve()
        self.assertEqual(server.put(b"hello")[0], 415)
        self.assertEqual(server.ask("PUT", f"{API}/photographs/{'0' * 64}", self.photos[0])[0], 422)
        self.assertEqual(server.ask("PUT", f"{API}/photographs/..%2f..%2fetc", self.photos[0])[0], 404)
        self.assertEqual(server.ask("POST", f"{API}/photographs/{'0' * 64}")[0], 405)
        status, headers, body = server.ask("GET", API + "/nothing")
        self.assertEqual((status, headers["Content-Type"]), (404, "application/problem+json"))
        self.assertEqual(json.loads(body)["status"], 404)

    def test_a_photograph_that_breaks_the_decoder(self):
        server = self.serve()
        broken = [self.photos[0][:len(self.photos[0]) // 2],  # truncated
                  b"\xff\xd8\xff\xe0" + bytes(range(256)) * 40,  # a JPEG by its beginning
                  b"P6\n60000 60000\n255\n" + b"x" * 100]  # a bomb
        slow = b"P6\n3000 2000\n255\n" + os.urandom(3000 * 2000 * 3)
        self.assertEqual(server.put(slow)[0], 201)
        decoder = self.wait_for(lambda: server.decoder_of(sha(slow)))
        self.assertNotEqual(os.getpgid(decoder), os.getpgid(server.process.pid), "a Ctrl-C is not for it")
        os.kill(decoder, signal.SIGSEGV)  # as a hole in a decoder would end it
        for data in broken:
            self.assertEqual(server.put(data)[0], 201)
        # Told at once, and not with the next photograph that makes a version.
        self.wait_for(lambda: server.json("/session")["counts"]["rejected"] == 4, 30)
        for photo in self.photos:
            self.assertEqual(server.put(photo)[0], 201)
        self.wait_for(lambda: server.json("/session")["counts"]["placed"] == 6)
        states = {one["sha256"]: one["state"] for one in server.json("/photographs")["photographs"]}
        self.assertEqual([sha256 for sha256, state in states.items() if state == "rejected"],
                         [sha(data) for data in (slow, *broken)])

    def test_tokens_are_not_on_the_disk(self):
        token = self.user("Ada")
        file = self.session / "users.json"
        self.assertEqual(file.stat().st_mode & 0o777, 0o600)
        self.assertNotIn(token, file.read_text())
        self.assertIn(sha(token.encode()), file.read_text())

    def test_roles_are_kept_apart(self):
        look, send, other = self.user("Look", "look"), self.user("Send"), self.user("Other")
        old = self.user("Old", "send", "--days", "0.00002")
        self.assertNotEqual(psfm("serve", "--session", self.session, "--add-user", "Send")[0], 0)
        server = self.serve()
        before = self.files()
        for path in ("/session", "/scene", "/scene/changes?after=0", "/events", "/photographs", "/replay", "/images/0",
                     "/images/0/thumbnail", "/points/0/0", "/pairs/0/1"):
            self.assertEqual(server.ask("GET", API + path)[0], 401, path)
        for token in ("x" * 43, look[:-1], look + "A", old):
            self.wait_for(lambda: server.ask("GET", API + "/session", token=token)[0] == 401, 5)
            self.assertEqual(server.put(self.photos[0], token=token)[0], 401)
        self.assertEqual(server.ask("GET", API + "/session", token=look)[0], 200)
        self.assertEqual(server.put(self.photos[0])[0], 401)
        self.assertEqual(server.put(self.photos[0], token=look)[0], 403)
        self.assertEqual(server.patch(self.photos[0], 0, len(self.photos[0]), 1000, token=look)[0], 403)
        self.assertEqual(server.ask("GET", API + "/photographs", token=look)[0], 403)
        self.assertEqual(self.files(), before)
        self.assertEqual(server.put(self.photos[0], token=send)[0], 201)
        self.assertEqual(server.json("/photographs", other)["photographs"], [])  # each sees his own
        self.assertEqual(server.json("/session", send)["me"], {"name": "Send", "role": "send"})
        psfm("serve", "--session", self.session, "--remove-user", "Send")
        self.wait_for(lambda: server.ask("GET", API + "/session", token=send)[0] == 401, 5)

    def test_a_link_becomes_a_cookie(self):
        token = self.user("Ada", "look")
        server = self.serve()
        status, headers, _ = server.ask("POST", API + "/login", json.dumps({"token": token}), Content_Type="application/json")
        self.assertEqual(status, 200)
        cookie = headers["Set-Cookie"]
        for word in ("HttpOnly", "SameSite=Strict"):
            self.assertIn(word, cookie)
        self.assertEqual(server.ask("GET", API + "/session", Cookie=cookie.split(";")[0])[0], 200)
        self.assertEqual(server.ask("GET", API + f"/session?token={token}")[0], 401)
        self.assertEqual(server.ask("POST", API + "/login", json.dumps({"token": token}), Content_Type="text/plain")[0], 415)
        self.assertIn("Secure", server.ask("POST", API + "/login", json.dumps({"token": token}), Content_Type="application/json",
                                           X_Forwarded_Proto="https")[1]["Set-Cookie"])

    def test_a_token_is_no_header(self):
        def login(token):
            return server.ask("POST", API + "/login", json.dumps({"token": token}), Content_Type="application/json")
        server = self.serve()
        odd = ("x\r\nX-More: 1", "x; Domain=example.org", "", "x" * 129, "\u00e4", "x\u0000", "x y")
        for token in odd:
            status, headers, _ = login(token)
            self.assertEqual((status, headers["X-More"], headers["Set-Cookie"]), (400, None, None), token)
        # Where whoever comes is the owner nobody needs a cookie.
        status, headers, body = login("x" * 43)
        self.assertEqual((status, json.loads(body)["role"], headers["Set-Cookie"]), (200, "owner", None))
        self.user("Ada")
        self.wait_for(lambda: login("x" * 43)[0] == 401, 10)
        for token in odd:
            self.assertEqual(login(token)[0], 400, token)

    def test_other_sites_are_refused(self):
        server = self.serve()
        data = self.photos[0]
        self.assertEqual(server.put(data, Origin="http://evil.example")[0], 403)
        self.assertEqual(server.put(data, Sec_Fetch_Site="cross-site")[0], 403)
        self.assertEqual(server.ask("GET", API + "/session", Sec_Fetch_Site="cross-site")[0], 403)
        self.assertNotIn("Access-Control-Allow-Origin", server.ask("GET", API + "/session")[1])
        self.assertEqual(server.put(data, Origin=f"http://{server.host}")[0], 201)

    def test_other_names_are_refused(self):
        server = self.serve("--host", "photos.example.org")
        self.assertEqual(server.ask("GET", API + "/session", Host="evil.example")[0], 421)
        self.assertEqual(server.ask("GET", API + "/session", Host=f"127.0.0.1:{server.port + 1}")[0], 421)
        self.assertEqual(server.ask("GET", API + "/session", Host="photos.example.org")[0], 200)

    def test_names_are_text(self):
        server = self.serve()
        name = "..%2F..%2F%3Cscript%3Ealert(1)%3C%2Fscript%3E%0A.jpg"
        self.assertEqual(server.put(self.photos[0], name)[0], 201)
        self.wait_for(lambda: server.json("/session")["image_list"])
        image = server.json("/session")["image_list"][0]
        self.assertEqual(image["title"], "../../<script>alert(1)</script>.jpg")
        self.assertEqual(image["name"], f"0/{sha(self.photos[0])}.jpg")
        self.assertEqual([file.name for file in (self.session / "photographs/0").iterdir()], [f"{sha(self.photos[0])}.jpg"])

    def test_every_answer_is_held_down(self):
        server = self.serve()
        for path in ("/", "/capture", "/viewer.js", "/style.css", API + "/session", "/nothing", API + "/nothing"):
            headers = server.ask("GET", path)[1]
            policy = headers["Content-Security-Policy"]
            for part in ("default-src 'none'", "script-src 'self'", "frame-ancestors 'none'", "base-uri 'none'", "form-action 'none'"):
                self.assertIn(part, policy)
            self.assertNotIn("unsafe", policy)
            self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
            self.assertEqual(headers["Referrer-Policy"], "no-referrer")

    def test_large_and_slow_requests(self):
        server = self.serve()
        self.assertIn(b" 431 ", server.raw(b"GET / HTTP/1.1\r\nX: " + b"a" * 9000 + b"\r\n\r\n"))
        self.assertIn(b" 400 ", server.raw(b"hello\r\n\r\n"))
        big = 65 << 20
        self.assertEqual(server.ask("PUT", f"{API}/photographs/{'a' * 64}", b"", Content_Length=str(big))[0], 413)
        self.assertEqual(server.ask("POST", API + "/login", b"x" * 5000, Content_Type="application/json")[0], 413)
        self.assertEqual(server.put(self.photos[0], Content_Encoding="gzip")[0], 415)
        slow = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(50)]
        for connection in slow:
            connection.sendall(b"GET / HTTP/1.1\r\nX: ")
        start = time.time()
        self.assertEqual(server.ask("GET", API + "/session")[0], 200)
        self.assertLess(time.time() - start, 5)
        slow[0].settimeout(30)
        answer = slow[0].recv(4096)  # cut off after ten seconds
        self.assertEqual(answer, b"")
        for connection in slow:
            connection.close()

    def test_smuggling_is_refused(self):
        server = self.serve()
        host = f"Host: {server.host}\r\n".encode()
        start = f"PUT {API}/photographs/{'a' * 64} HTTP/1.1\r\n".encode() + host
        for headers in (b"Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
                        b"Content-Length: 5\r\nContent-Length: 6\r\n\r\nhello",
                        b"Transfer-Encoding: chunked\r\n\r\n-2\r\n",
                        b"Content-Length: -1\r\n\r\n",
                        host + b"Content-Length: 5\r\n\r\nhello"):
            answer = server.raw(start + headers, 15)
            self.assertRegex(answer[:20], rb"HTTP/1.1 4\d\d", (headers, answer))
            self.assertEqual(answer.count(b"HTTP/1.1"), 1, headers)

    def test_the_disk_is_kept_free(self):
        server = self.serve(keep_free=1 << 40)
        self.assertEqual(server.put(self.photos[0])[0], 507)
        self.assertEqual(list((self.session / "photographs").rglob("*.jpg")), [])
        server.stop()
        server = self.serve("--quota", "0")
        self.assertEqual(server.put(self.photos[0])[0], 507)

    def test_no_position_is_told(self):
        server = self.serve_finished()
        self.assertTrue(all(b"GPS" in photo or b"\x88\x25" in photo or b"\x25\x88" in photo for photo in self.photos))
        for path in ("/session", "/photographs", "/images/0"):
            text = server.ask("GET", API + path)[2].decode()
            self.assertNotRegex(text, "(?i)latitude|longitude|gps|datum|altitude")
        status, _, picture = server.ask("GET", API + "/images/0/thumbnail")  # the session has been moved: it is found
        self.assertEqual((status, picture[:2]), (200, b"\xff\xd8"))
        self.assertNotIn(b"Exif", picture)
        for path in (f"/photographs/{sha(self.photos[0])}", "/images/0/photograph", f"/photographs/0/{sha(self.photos[0])}.jpg"):
            self.assertIn(server.ask("GET", API + path)[0], (404, 405), path)

    def test_answers_are_as_the_api_says(self):
        server = self.serve_finished()
        number = int.from_bytes(server.ask("GET", API + "/scene")[2][4:8], "little")
        self.assertEqual(server.ask("GET", API + "/scene/changes?after=0")[0], 410)  # of another server, or long ago
        point = server.json("/images/0")["observations"][0]
        names = {"image": 0, "cluster": point["cluster"], "slot": point["slot"], "first": 0, "second": 1,
                 "sha256": sha(self.photos[0])}
        description = json.loads(OPENAPI.read_text())
        for path, operations in description["paths"].items():
            url = API + path.format(**names) + (f"?after={number}" if path.endswith("changes") else "")
            for method in {"get", "head", "patch", "put", "post", "delete"} - {"head"}:
                if method in operations:
                    continue
                answer = server.ask(method.upper(), url)[0] if not path.endswith("events") or method != "get" else 405
                self.assertIn(answer, (400, 401, 405, 415), (method, path))
            for method, operation in operations.items():
                if path == "/events":
                    continue
                of_nobody = url.replace(names["sha256"], "0" * 64)
                status, headers, body = server.ask(method.upper(), of_nobody if method == "delete" else url)
                said = operation["responses"].get(str(status), operation["responses"]["4XX"] if status // 100 == 4 else None)
                self.assertIsNotNone(said, (method, path, status))
                if status == 200 and "content" in said:
                    kind, content = next(iter(said["content"].items()))
                    self.assertTrue(headers["Content-Type"].startswith(kind), (path, headers["Content-Type"]))
                    for name in content.get("schema", {}).get("required", []):
                        self.assertIn(name, json.loads(body), path)
                if status // 100 == 4 and body:
                    self.assertEqual(set(json.loads(body)), {"type", "title", "status", "detail"})

    def test_what_a_database_began_takes_no_photographs(self):
        scene = self.session.parent / "scene"
        self.assertEqual(psfm("simulate", "--scene", "courtyard", "--images", "8", "--output", scene)[0], 0)
        self.assertEqual(psfm("import", "--colmap-database", scene / "database.db", "--session", self.session)[0], 0)
        with self.assertRaisesRegex(RuntimeError, "begun from .*database.db; continue it with `psfm import`"):
            self.serve()
        self.assertEqual(psfm("serve", "--session", self.session, "--listen", "127.0.0.1:0")[0], 3)
        self.assertFalse((self.session / "photographs").exists())
        self.serve(command="view")

    def test_a_model_that_positions_place_is_in_metres(self):
        server = self.serve()
        for i, photo in enumerate(self.photos):
            self.assertEqual(server.put(at_place(photo, 10 * i), f"IMG_{i}.jpg")[0], 201)
        session = self.wait_for(lambda: (said := server.json("/session"))["in_metres"] and said)
        self.assertEqual(session["up"], [0.0, 0.0, 1.0])
        self.assertNotRegex(json.dumps(session), "(?i)latitude|longitude|gps|datum|altitude")

    def test_no_users_no_network(self):
        code, _, err = psfm("serve", "--session", self.session, "--listen", "0.0.0.0:0")
        self.assertEqual(code, 3)
        self.assertIn("--add-user", err)

    def test_what_to_go_on_with_has_all_that_was_asked_for(self):
        server = self.serve("--host", "photos.example.org", "--host", "a b", "--quota", "5")
        self.assertEqual(server.stop(), 0)
        self.assertIn("--listen 127.0.0.1:0 --host photos.example.org --host 'a b' --quota 5 --keep-free 1\n", server.errors)
        self.serve().stop()
        self.assertNotIn("--host", self.server.errors)

    def test_view_is_for_looking(self):
        self.serve_finished().stop()
        if "built without pages" in psfm("view", "--session", self.session, "--output", self.shared / "model.html")[2]:
            self.skipTest("psfm was built without pages")
        server = self.serve(command="view")
        self.assertEqual(server.json("/session")["counts"]["placed"], 6)
        self.assertEqual(server.json("/session")["me"]["role"], "look")
        self.assertEqual(server.put(self.photos[0])[0], 404)

    def test_the_page_doubts_the_models_that_status_doubts(self):
        scene = self.session.parent / "scene"
        self.assertEqual(psfm("simulate", "--scene", "courtyard", "--images", "20", "--output", scene)[0], 0)
        self.assertEqual(psfm("import", "--colmap-database", scene / "database.db", "--session", self.session,
                              "--set", "solve.assessment.weak_angle_deg=90")[0], 0)
        weak = json.loads(psfm("status", "--session", self.session, "--json")[1])["weak_models"]
        self.assertTrue(weak)
        server = self.serve(command="view")
        self.assertEqual(server.json("/session")["weak_models"], weak)
        versions = [data for kind, data, _ in self.events(1, last_id=self.first_id()) if kind == "version"]
        self.assertEqual(json.loads(versions[-1])["weak_models"], weak)


if __name__ == "__main__":
    OPENAPI = Path(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
