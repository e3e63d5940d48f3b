#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Who may do what in psfm serve, and until when; the command line that makes users and takes them back.
Usage: rights_test.py BUILD [TEST …]"""
import fcntl
import json
import socket
import sys
import time
import unittest
from concurrent.futures import ThreadPoolExecutor

from serve_case import ServeCase, psfm
from server import API, sha

SOON = 10  # s: what takes two at most, on slow machines, too


class Rights(ServeCase):
    def login(self, server, token):
        return server.ask("POST", API + "/login", json.dumps({"token": token}), Content_Type="application/json")[0]

    def remove(self, name):
        self.assertEqual(psfm("serve", "--session", self.session, "--remove-user", name)[0], 0)

    def stream(self, token):
        """A connection to which events come, its beginning read."""
        connection = socket.create_connection(("127.0.0.1", self.server.port), timeout=60)
        self.addCleanup(connection.close)
        connection.sendall(f"GET {API}/events HTTP/1.1\r\nHost: {self.server.host}\r\nAuthorization: Bearer {token}\r\n\r\n".encode())
        beginning = b""
        while b"event: hello" not in beginning:
            beginning += connection.recv(4096)
        return connection

    def seconds_until_it_ends(self, connection):
        start = time.time()
        while connection.recv(65536):
            pass
        return time.time() - start

    def begin_upload(self, data, token, count):
        """A PUT that was let in, of which `count` bytes are sent."""
        connection = socket.create_connection(("127.0.0.1", self.server.port), timeout=60)
        self.addCleanup(connection.close)
        head = (f"PUT {API}/photographs/{sha(data)} HTTP/1.1\r\nHost: {self.server.host}\r\n"
                f"Content-Length: {len(data)}\r\nExpect: 100-continue\r\nAuthorization: Bearer {token}\r\n\r\n")
        connection.sendall(head.encode())
        self.assertIn(b" 100 ", connection.recv(4096))
        connection.sendall(data[:count])
        return connection

    def test_wrong_tokens_are_slowed_down(self):
        token = self.user("Ada")
        server = self.serve()
        while time.time() % 60 > 50:  # failures are counted by the minute
            time.sleep(1)
        answers = [server.ask("GET", API + "/session", token="x" * 43)[0] for _ in range(12)]
        self.assertEqual(answers, [401] * 10 + [429] * 2)
        self.assertEqual(self.login(server, "x" * 43), 429)
        self.assertEqual(server.ask("GET", API + "/session")[0], 401)
        # Others behind the same address go on.
        self.assertEqual(server.ask("GET", API + "/session", token=token)[0], 200)
        self.assertEqual(self.login(server, token), 200)

    def test_a_stream_ends_with_the_link(self):
        gone, other, old = self.user("Gone", "look"), self.user("Other", "look"), self.user("Old", "look", "--days", "0.0001")
        server = self.serve()
        streams = [self.stream(token) for token in (gone, other)]
        expiring = self.stream(old)
        self.remove("Gone")
        self.assertLess(self.seconds_until_it_ends(streams[0]), SOON)
        self.assertLess(self.seconds_until_it_ends(expiring), 9 + SOON)
        self.assertEqual(server.ask("GET", API + "/session", token=old)[0], 401)
        streams[1].settimeout(2)
        with self.assertRaises(TimeoutError):  # is still there, and nothing happens
            streams[1].recv(1)

    def test_an_upload_that_ends_after_the_removal_is_not_taken(self):
        token = self.user("Gone")
        server = self.serve()
        data = self.photos[0]
        upload = self.begin_upload(data, token, len(data) // 2)
        self.remove("Gone")
        self.wait_for(lambda: server.ask("GET", API + "/session", token=token)[0] == 401, SOON)
        upload.sendall(data[len(data) // 2:])
        self.assertIn(b" 401 ", upload.recv(4096))
        self.assertEqual(list(self.session.glob("photographs/*/*.jpg")), [])
        self.assertFalse((self.session / "uploads.log").exists())

    def test_a_lost_file_of_users_opens_nothing(self):
        token = self.user("Ada")
        server = self.serve()
        file = self.session / "users.json"
        kept = file.read_text()
        for text in (None, "", '{"users": []}'):
            file.unlink()
            if text is not None:
                file.write_text(text)
            time.sleep(1.2)
            for _ in range(3):
                self.assertEqual(server.ask("GET", API + "/session")[0], 401, text)
            self.assertEqual(server.put(self.photos[0])[0], 401, text)
            file.write_text(kept)
        self.wait_for(lambda: server.ask("GET", API + "/session", token=token)[0] == 200, SOON)
        server.stop()
        server = self.serve(listen="0.0.0.0:0")  # had users when it began
        file.unlink()
        time.sleep(1.2)
        self.assertEqual(server.ask("GET", API + "/session")[0], 401)

    def test_the_first_user_closes_a_server_that_runs(self):
        server = self.serve()
        self.assertEqual(server.ask("GET", API + "/session")[0], 200)
        stream = self.stream("")
        self.user("Ada")
        self.wait_for(lambda: server.ask("GET", API + "/session")[0] == 401, SOON)
        self.assertLess(self.seconds_until_it_ends(stream), SOON)

    def test_changes_of_users_at_the_same_time_are_all_made(self):
        gone = [self.user(f"Gone{k}") for k in range(3)]
        server = self.serve()
        with ThreadPoolExecutor(9) as pool:
            added = [pool.submit(self.user, f"User{k}") for k in range(6)]
            removed = [pool.submit(self.remove, f"Gone{k}") for k in range(3)]
            tokens = [one.result() for one in added]
            for one in removed:
                one.result()
        listed = psfm("serve", "--session", self.session, "--list-users")[1]
        self.assertEqual(sorted(line.split(",")[0] for line in listed.splitlines()), [f"User{k}" for k in range(6)])
        time.sleep(1.2)  # the server looks at its users every second
        for token in tokens:
            self.assertEqual(server.ask("GET", API + "/session", token=token)[0], 200)
        for token in gone:
            self.assertEqual(server.ask("GET", API + "/session", token=token)[0], 401)

    def test_a_first_user_waits_for_who_makes_the_session(self):
        self.session.mkdir()
        with (self.session / "writer.lock").open("w") as lock, ThreadPoolExecutor(1) as pool:
            lock.write("psfm session lock\n")
            lock.flush()
            fcntl.flock(lock, fcntl.LOCK_EX)
            user = pool.submit(self.user, "Ada")
            time.sleep(2)
            fcntl.flock(lock, fcntl.LOCK_UN)
            self.assertTrue(user.result())

    def test_nobody_takes_all_of_the_places(self):
        one, other = self.user("One"), self.user("Other")
        server = self.serve()
        for photo in self.photos[:4]:
            self.begin_upload(photo, one, 100)
        status, headers, _ = server.put(self.photos[4], token=one)
        self.assertEqual(status, 429)
        self.assertTrue(headers["Retry-After"])
        self.assertEqual(server.put(self.photos[5], token=other)[0], 201)

    def test_names_of_hosts_have_letters_of_any_size(self):
        server = self.serve("--host", "Photos.example.org")
        for host in ("photos.example.org", "PHOTOS.example.org", f"LocalHost:{server.port}"):
            self.assertEqual(server.ask("GET", API + "/session", Host=host)[0], 200, host)
        self.assertEqual(server.put(self.photos[0], Host="Photos.Example.org", Origin="https://photos.example.org")[0], 201)

    def test_the_command_line_is_looked_at(self):
        def serve(*options):
            return psfm("serve", "--session", self.session, *options)
        for days in ("-1", "nan", "inf", "1e9", "two"):
            self.assertNotEqual(serve("--add-user", "Ada", "--days", days)[0], 0, days)
        for link in ("photos.example.org", "ftp://photos.example.org", "https://"):
            self.assertNotEqual(serve("--add-user", "Ada", "--link", link)[0], 0, link)
        self.assertFalse(self.session.exists())
        for name in ("  ", "a\nb", "x" * 65):
            code, out, err = serve("--add-user", name)
            self.assertEqual((code, out), (3, ""), name)
            self.assertIn("64 bytes", err)
        self.assertEqual(serve("--remove-user", "Ada")[0], 3)
        for option in ("--add-user", "--remove-user"):
            self.assertEqual(serve(option, "")[0], 2, option)
        for words in (("--quota", -5), ("--quota", 2**64), ("--keep-free", -1), ("--keep-free", 2**44)):
            code, _, err = serve(*words)
            self.assertEqual(code, 2, words)
            self.assertIn(words[0], err)
        other = self.session / "other"
        for words in (("--remove-user", "Ada"), ("--list-users",)):
            code, _, err = psfm("serve", "--session", other, *words)
            self.assertEqual(code, 3)
            self.assertIn("is no session", err)
            self.assertFalse(other.exists())
        code, out, err = serve("--add-user", "Ada", "--link", "https://photos.example.org/")
        self.assertRegex(out, r"^https://photos\.example\.org/capture#token=")
        self.assertEqual(err, "")
        self.assertIn("--link", serve("--add-user", "Bob", "--role", "look", "--days", "2")[2])

    def test_users_are_listed_without_tokens(self):
        tokens = [self.user("Ada", "owner"), self.user("Bob", "look", "--days", "2"), self.user("Gone")]
        self.remove("Gone")
        code, out, _ = psfm("serve", "--session", self.session, "--list-users")
        self.assertEqual(code, 0)
        self.assertRegex(out, r"^Ada, owner, since \d{4}-\d\d-\d\d \d\d:\d\d\nBob, look, since [-\d: ]+, expires [-\d: ]+\n$")
        for token in tokens:
            self.assertNotIn(token, out)
            self.assertNotIn(sha(token.encode()), out)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
