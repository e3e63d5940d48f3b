#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests and photographs, mutated from valid ones of every kind, against psfm serve: it lives, answers within 30 s
and with no 5xx but 503 and 507, and who may not write or read does not. What is found is in ./FINDING-n.bin.
usage: fuzz_server.py BUILD [--requests N] [--photographs N] [--seed N] [--threads N]
By hand: fuzz_server.py build/release --requests 100000 --photographs 10000"""
import argparse
import atexit
import base64
import contextlib
import json
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from random import Random

from server import API, Server, sha

HANG_SECONDS = 30
BATCH = 500  # requests until the server is looked at, photographs until it has its first session again
NO_HTTP = (b"this is no request that can be understood", b"the header of the request is too long")
NUMBERS = (b"-1 0 1 2147483647 2147483648 4294967295 4294967296 9007199254740993 9223372036854775808 %31 1.5 0x10 NaN "
           b"18446744073709551615 18446744073709551616 1e309 00000000001").split() + [b"", b"9" * 400]
ESCAPES = (b"%00 %2e%2e/ ../ ..%2f..%2f %5c..%5c \\ % %z %ff%fe // / /./ %0d%0aX:%20y \xc3\xa9 %25 ? # & = \0 ;a=b "
           b"%c0%ae%c0%ae/").split() + [b"a" * 300, b"../" * 100, b"%41" * 2000, b"a/" * 3000, b"a" * 9000]
METHODS = b"GET HEAD POST PUT PATCH DELETE OPTIONS TRACE CONNECT PROPFIND get M-SEARCH GETGETGET".split()
HEADERS = (b"Content-Length Content-Length Transfer-Encoding Transfer-Encoding Upload-Offset Upload-Length Cookie "
           b"Origin Connection Upgrade Accept-Encoding Content-Encoding Content-Type Host Sec-Fetch-Site Expect Range "
           b"Authorization Last-Event-ID X-Forwarded-Proto If-None-Match X\xff").split()
VALUES = (b"chunked|gzip, chunked|identity|xchunked|gzip|bytes=0-0|bytes=-1|bytes=18446744073709551615-|100-continue|"
          b"close|upgrade|http://a.example|127.0.0.1|[::1|a:b:c|cross-site|same-origin|https|psfm_token=|Bearer|"
          b"a=b; psfm_token=x|Basic Og==|application/json|application/offset+octet-stream|1-1|\xff").split(b"|")
VALUES += NUMBERS + [part * count for part in (b"bytes=0-0,", b"; ", b"Bearer x", b"x") for count in (500, 1000, 9000)]
BODIES = [b"", b'{"token":1}', b'{"token":"\\u0000"}', b'{"token":"\\ud800"}', b'{"token":"a\\r\\nB: c"}', b"0\r\n\r\n",
          b'{"token":"\xff"}', b'{"token":' * 400, b"[" * 4000, b"\0" * 5000, b"x" * 100000]
AVIF = zlib.decompress(base64.b85decode(  # 72 x 64 pixels by libheif 1.15: no program that is there for sure writes it
    "c-muNV30{GsVqn=%S>Yc0uY^>nP!-qnF!*)%1tdvWPkw0jFg-rD4U@mGr5ET4e%9YmgIt2j6kfEnUkLk;<z{f`HWy;J_rp27C@|=nVFXcS1$_Wq"
    "%uKyiDd?cAZAu(K~Vva_RcIw&Ii)M$@w`&dC55y3`{`C)&LaZNh~vTZe-vADHq8sE=Yyi-~q%AKrB#@S&<16VCLZ908-+a1-URU0o}#Y*u>ldQk"
    "t8RSR%y0#VH|~{O=$W6I+Xsrt1Ut|Nnn1IOwx;-x?96_V3rjc@nLkOkyxjemrgVyaE%`o4=<T?Bv=P3;>>rL#6"))


def replaced(rng, pattern, values, data):
    match = rng.choice(list(re.finditer(pattern, data)) or [None])
    return data[:match.start()] + rng.choice(values) + data[match.end():] if match else data


def odd_bytes(rng, data):
    """Flipped, inserted, removed or repeated; more of them in front, where headers are."""
    at, count = int(len(data) * rng.random() ** 2), rng.choice([1, 1, 2, 4, 16, 64])
    part, rest = data[at:at + count], data[at + count:]
    flipped = bytes(byte ^ (1 << rng.randrange(8)) for byte in part)
    return data[:at] + rng.choice([flipped, part + rng.randbytes(count), b"", part * rng.choice([2, 3, 20])]) + rest


def with_header(lines, name, value):
    return [line for line in lines if not line.startswith(name + b":")] + [name + b": " + value]


def odd_lines(rng, lines):
    k, many = rng.randrange(1, len(lines) + 1), [b"X-%d: y" % i for i in range(rng.choice([50, 200, 1000]))]
    start, one, rest = lines[:k], lines[k:k + 1], lines[k + 1:]
    return rng.choice([[lines[0], *rng.sample(lines[1:], len(lines) - 1)], lines + many, lines + one, start + rest,
                       start + [line.lower() for line in one] + rest])


def odd_target(rng, lines):
    method, rest = lines[0].split(b" ", 1)
    target, version = rest.rsplit(b" ", 1)
    if rng.random() < 0.4:
        return [b" ".join([rng.choice(METHODS), target, version]), *lines[1:]]
    query = rng.choice([b"", b"", b"?name=", b"&name=", b"?after=", b"&", b"?%00="])
    at = len(target) if query else rng.randrange(len(target) + 1)
    odd = query + rng.choice([*ESCAPES, *NUMBERS, b"%ff" * 100, rng.randbytes(20)])
    return [b" ".join([method, target[:at] + odd + target[at + rng.choice([0, 0, 1, 5]):], version]), *lines[1:]]


def odd_body(rng, lines, body):
    how, size, is_put = rng.randrange(5), rng.choice([7, 100, 1000]), lines[0].startswith(b"PUT")
    if how == 0:
        parts = [body[i:i + size] for i in range(0, len(body), size)] + [b""]
        lines = [line for line in lines if not line.startswith(b"Content-Length:")] + [b"Transfer-Encoding: chunked"]
        return lines, b"".join(b"%x\r\n%b\r\n" % (len(part), part) for part in parts)
    body = rng.choice(BODIES) if how == 1 else body[:rng.randrange(len(body) + 1)] if how == 2 else odd_bytes(rng, body)
    if how == 3 and is_put:  # by its right name it goes on to what looks at its kind
        lines = [f"PUT {API}/photographs/{sha(body)} HTTP/1.1".encode(), *lines[1:]]
    return with_header(lines, b"Content-Length", b"%d" % len(body)) if rng.random() < 0.75 else lines, body


def with_right_checksums(data):
    out, at = bytearray(data), 8
    while (end := at + 8 + int.from_bytes(out[at:at + 4], "big")) + 4 <= len(out):
        out[end:end + 4] = struct.pack(">I", zlib.crc32(out[at + 4:end]))
        at = end + 4
    return bytes(out)


def valid_photographs(folder):
    """What tests/fuzz/make_seeds.cpp has encoded there, and kinds that it does not encode."""
    files = [*folder.glob("seeds/photo/*"), *folder.glob("seeds/heif/exif*")]
    photos = {file.name: file.read_bytes() for file in sorted(files)}
    pixels = [Random(y // 8 * 9 + x // 8).randbytes(4) for y in range(64) for x in range(72)]
    grey, colour, alpha = (b"".join(pixel[:channels] for pixel in pixels) for channels in (1, 3, 4))
    rows = zlib.compress(b"".join(b"\0" + alpha[i:i + 4 * 72] for i in range(0, len(alpha), 4 * 72)))
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", 72, 64, 8, 6, 0, 0, 0)), (b"IDAT", rows), (b"IEND", b""))
    png = b"\x89PNG\r\n\x1a\n" + b"".join(struct.pack(">I", len(one)) + name + one + bytes(4) for name, one in chunks)
    index = b"\xff\xe2\0\x20MPF\0MM\0*\0\0\0\x08\0\x01\xb0\0\0\x07\0\0\0\x040100\0\0\0\0"  # CIPA DC-007
    return [*photos.values(), AVIF, with_right_checksums(png),
            b"P5\n# grey\n72 64\n255\n" + grey, b"P6 72 64\n65535\n" + colour * 2,
            b"P3\n72 64\n255\n" + b" ".join(b"%d" % value for value in colour) + b"\n",
            struct.pack("<2sIIIIHHHH", b"BM", 0, 0, 26, 12, 72, 64, 1, 24) + colour,
            photos["exif.jpg"][:2] + index + photos["exif.jpg"][2:] + photos["plain.jpg"]]


def odd_part(rng, data):
    """A length, size or offset beside the name of a chunk, box or marker, or the part between two such names."""
    names = [match.start() for match in re.finditer(rb"[A-Za-z]{3}[A-Za-z0-9 ]|\xff[\xc0-\xfe]", data)] or [0]
    (at, end), other = sorted(rng.choices(names, k=2)), rng.choice(names)
    how, width = rng.randrange(4), rng.choice([1, 2, 4, 4, 8])
    if how < 2:
        return data[:at] + rng.choice([b"", data[at:end] * 2, data[other:other + end - at]]) + data[end:]
    at = max(0, other + rng.choice([-4, 2, 4, 8, 12])) if how == 2 else int(len(data) * rng.random() ** 2)
    value = rng.choice([0, 1, 2, 1 << 7, 1 << 15, 1 << 31, 1 << 63, len(data)]) - rng.randrange(2)
    return data[:at] + (value % (1 << 8 * width)).to_bytes(width, rng.choice(["big", "little"])) + data[at + width:]


def fuzzed_photograph(rng, photos):
    data = rng.choice(photos)
    for _ in range(rng.choice([1, 1, 2, 3, 4])):
        how, other, cut = rng.randrange(10), rng.choice(photos), rng.randrange(len(data) + 1)
        if how < 2:
            data = data[:cut] + [b"", other[rng.randrange(len(other)):]][how]
        elif how < 5 and data[:1] == b"P":
            data = replaced(rng, rb"\d+", NUMBERS, data[:40]) + data[40:]
        else:
            data = odd_bytes(rng, data) if how < 5 else odd_part(rng, data)
    return with_right_checksums(data) if data[1:4] == b"PNG" and rng.random() < 0.8 else data


class Fuzzer:
    def __init__(self, asked, folder, pool):
        self.asked, self.folder, self.pool, self.psfm = asked, folder, pool, asked.build / "psfm"
        self.seed, self.tokens, self.findings = asked.seed * 10**9, {}, 0
        self.requests, self.photographs = Counter(), Counter()  # by status, and what else is counted

    def found(self, why, data=b""):
        self.findings += 1
        Path(f"FINDING-{self.findings}.bin").write_bytes(data)
        print(f"FINDING-{self.findings}.bin: {why}: {data[:3000]!r}", file=sys.stderr, flush=True)

    def credentials(self, rng, role):
        """@return a token, a header with it. Without such a role: a wrong one"""
        right = self.tokens["send"]
        wrong = rng.choice([right[:-3], right[3:], right[::-1], right[:20] + "A" * 23, "x" * 43, "-", "a" * 2000])
        token = self.tokens.get(role, wrong).encode()
        return token, rng.choice([(b"Authorization", b"Bearer " + token), (b"Cookie", b"a=b; psfm_token=" + token)])

    def valid_request(self, rng, roles):
        """@return the lines of its head, its body"""
        method, path = rng.choice(self.operations)
        names = {name: value for group in self.names for name, value in rng.choice(group).items()}
        role, body, more = rng.choice(roles), b"", []
        token, header = self.credentials(rng, role)
        if method == "POST":
            more, body = [(b"Content-Type", b"application/json")], b'{"token":"' + token + b'"}'
        if method in ("PUT", "PATCH"):
            body = rng.choice([*self.valid[:6], *[rng.randbytes(300)] * 3])  # what is here already is not read again
            names["sha256"] = rng.choice([sha(body), sha(b"%d" % rng.randrange(64))]) + "?name=IMG_1.jpg"
        if method == "PATCH":
            start, end = rng.choice([0, 0, len(body) // 3]), rng.choice([len(body), len(body) // 2])
            more = [(b"Upload-Offset", b"%d" % start), (b"Upload-Length", b"%d" % len(body)),
                    (b"Content-Type", b"application/offset+octet-stream")]
            body = body[start:end]
        more += [(b"Content-Length", b"%d" % len(body))] * bool(body) + [header] * (role != "none")
        headers = [(b"Host", self.server.host.encode()), *more] + [(b"Accept-Encoding", b"gzip")] * rng.randrange(2)
        return [f"{method} {path.format(**names)} HTTP/1.1".encode(), *(b"%b: %b" % header for header in headers)], body

    def fuzzed_request(self, rng, roles):
        """Most mutations leave HTTP as it is, for the routes; the others are for its parser."""
        lines, body = self.valid_request(rng, roles)
        hows = rng.choices("number header target target lines body token bytes".split(), k=rng.randrange(5))
        for how in hows:
            if how == "number":  # not those of the address, nor of a hash or the version
                lines = replaced(rng, rb"(?<=[/= ])\d+(?=[/ \r&?])", NUMBERS, b"\r\n".join(lines)).split(b"\r\n")
            elif how == "header":
                name, value = rng.choice(HEADERS), rng.choice(VALUES)
                lines = with_header(lines, name, value) if rng.random() < 0.7 else [*lines, name + b": " + value]
            elif how in ("target", "lines"):
                lines = (odd_target if how == "target" else odd_lines)(rng, lines)
            elif how == "body":
                lines, body = odd_body(rng, lines, body)
            elif how == "token":
                lines = with_header(lines, *self.credentials(rng, rng.choice([*roles, "wrong"]))[1])
        raw = b"\r\n".join(lines) + b"\r\n\r\n" + body
        for _ in range(hows.count("bytes")):
            other = b"\r\n".join(self.valid_request(rng, roles)[0]) + b"\r\n\r\n"
            cut, version = rng.randrange(len(raw) + 1), rng.choice([b"HTTP/1.0", b"HTTP/2.0", b""])
            raw = rng.choice([odd_bytes(rng, raw), odd_bytes(rng, raw), raw[:cut], raw[:cut] + other[cut % len(other):],
                              raw + other, raw.replace(b"\r\n", b"\n"), raw.replace(b"HTTP/1.1", version)])
        return raw

    def exchange(self, data, address="127.0.0.1"):
        """@return all that is answered, of events the beginning; whether that took too long"""
        end, answer, server = time.monotonic() + HANG_SECONDS, b"", ("127.0.0.1", self.server.port)
        with contextlib.suppress(OSError), socket.create_connection(server, HANG_SECONDS, (address, 0)) as connection:
            # Closed at once: events that nobody reads would count as a connection until they are written to.
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            with contextlib.suppress(OSError):  # refused before all was sent: there is an answer
                connection.sendall(data)
                connection.shutdown(socket.SHUT_WR)  # else the rest of half a request would be waited for
            while b"text/event-stream" not in answer and (chunk := connection.recv(1 << 18)):
                answer += chunk
                connection.settimeout(max(0.001, end - time.monotonic()))
        return answer, time.monotonic() >= end

    def ask(self, number, roles):
        """@return the request, its status, whether it was HTTP, what is wrong"""
        data = self.fuzzed_request(Random(self.seed + number), roles)
        # Ten wrong tokens a minute are borne from an address, and then nothing at all.
        answer, hangs = self.exchange(data, f"127.1.{number // 1000 % 250}.{1 + number // 4 % 250}")
        heads = re.findall(rb"HTTP/1\.1 (?!100)(\d{3}) .*?\r\n(.*?)\r\n\r\n", answer, re.DOTALL)
        wrong = [f"no answer after {HANG_SECONDS} s"] * hangs
        wrong += [f"status {status}" for status, _ in heads if status[:1] == b"5" and status not in (b"503", b"507")]
        whole = re.sub(rb"\r\n[0-9a-fA-F]+\r\n", b"", data)  # of tokens in chunks
        if not any(token.encode() in data + whole for token in self.tokens.values()):
            told = [head for status, head in heads if status[:1] == b"2" and status != b"204"]
            wrong += ["told without a token" for head in told if not re.search(rb"Content-Type: text/(?!event)", head)]
        if any(secret in answer for secret in self.secrets):  # half of the answers are not compressed
            wrong.append("an original or a position was told")
        is_http = bool(heads) and not any(words in answer[:2000] for words in NO_HTTP)
        return data, heads[0][0].decode() if heads else "none", is_http, wrong

    def look_after(self, suspects):
        """The server lives and answers; if not, one of these did it."""
        with contextlib.suppress(OSError):
            if self.server.ask("GET", API + "/session", token=self.tokens["owner"])[0] == 200:
                return
        for data in suspects:
            self.found(f"the server ended ({self.server.process.poll()}) or is mute, perhaps by this", data)
        self.server.stop()
        sys.exit(f"the server is gone: {self.server.errors}")

    def fuzz_requests(self, numbers, roles):
        for batch in (numbers[i:i + BATCH] for i in range(0, len(numbers), BATCH)):
            answers = list(self.pool.map(lambda number: self.ask(number, roles), batch))
            for data, status, is_http, wrong in answers:
                self.requests.update([status] + ["http"] * is_http)
                for why in wrong:
                    self.found(why, data)
            self.look_after([data for data, status, _, _ in answers if status == "none"][:16])

    def state(self):
        session = self.server.json("/session", self.tokens["owner"])
        files = [*self.session.glob("photographs/**/*"), self.session / "uploads.log", self.session / "users.json"]
        return session["counts"], session["image_list"], {one: one.read_bytes() for one in files if one.is_file()}

    def settled(self, suspects=(), quiet_seconds=3):
        """Nothing has happened for a while, longer than a decoder may take if one may run. @return states, by hash"""
        quiet, before, queued = 0, None, []
        while quiet < (200 if queued else quiet_seconds):
            time.sleep(1)
            self.look_after(suspects)
            counts = self.server.json("/session", self.tokens["owner"])["counts"]
            mine = [self.server.json("/photographs", self.tokens[role])["photographs"] for role in ("owner", "send")]
            states = {one["sha256"]: one["state"] for one in sum(mine, [])}
            queued = [sha256 for sha256, state in states.items() if state == "queued"]
            quiet, before = quiet + 1 if before == (counts, states) else 0, (counts, states)
        for sha256 in queued:
            self.found("accepted and never judged", next(self.session.glob(f"*/*/{sha256}.*[!t]")).read_bytes())
        return states

    def put(self, number, data):
        """@return status, once the server has not enough to look at any more; whether that is wrong"""
        head = (f"PUT {API}/photographs/{sha(data)}?name={number} HTTP/1.1\r\nHost: {self.server.host}\r\n"
                f"Content-Length: {len(data)}\r\nAuthorization: Bearer {[*self.tokens.values()][number % 2]}\r\n\r\n")
        # 423: another thread is sending the same one
        while (answer := self.exchange(head.encode() + data))[0][9:12] in (b"423", b"429"):
            time.sleep(0.5)
        status = answer[0][9:12].decode()
        return status, answer[1] or status not in ("200", "201", "413", "415" if data else "422", "503", "507")

    def fuzz_photographs(self, total):
        for start in range(0, total, BATCH):
            self.begin(f"photographs-{start}")  # anew, since the API takes none out again
            seeds = range(self.seed + start, self.seed + min(start + BATCH, total))
            made = self.valid + [fuzzed_photograph(Random(seed), self.valid) for seed in seeds]
            answers = list(self.pool.map(self.put, range(len(made)), made))
            states = self.settled(made)
            for k, (data, (status, is_wrong)) in enumerate(zip(made, answers)):
                state = states.get(sha(data), "no photograph")
                if is_wrong or (k < len(self.valid) and state == "rejected"):
                    self.found(f"photograph: {status}, {state}", data)
                self.photographs.update([status, state] * (k >= len(self.valid)))
            for image in range(0, len(states), 10):
                path = f"{API}/images/{image}/thumbnail"
                if self.server.ask("GET", path, token=self.tokens["look"])[0] not in (200, 404):
                    self.found(path)
            self.end()

    def begin(self, name):
        self.session = self.folder / name
        if name != "first":
            shutil.copytree(self.folder / "first", self.session)
        self.server = Server(self.asked.build, self.session)
        atexit.register(self.server.process.kill)
        return self.settled()

    def end(self):
        if (code := self.server.stop()) != 0:
            self.found(f"the server ended with {code}: {self.server.errors}")
        if code := subprocess.call([self.psfm, "check", "--session", self.session], stdout=subprocess.DEVNULL):
            self.found(f"psfm check ends with {code}")

    def secrets_of(self, file):
        """Parts of a photograph's EXIF data and picture, and its position to 1 m."""
        data = file.read_bytes()
        exif, tables, scan = data.index(b"Exif\0\0"), data.index(b"\xff\xdb") - 24, data.rindex(b"\xff\xda") + 50
        parts = [data[at:at + 24] for at in (*range(exif, tables, 12), *range(scan, len(data) - 24, 8000))]
        out = subprocess.check_output([self.psfm, "decode-photograph", file])
        position = json.JSONDecoder().raw_decode(out[8:].decode("latin-1"))[0]["gps"]
        return {part for part in parts if len(set(part)) > 6} | {f"{one:.7f}"[:-2].encode() for one in position[:2]}

    def prepare(self):
        words = [self.folder / "wall", *"--scene wall --images 5 --gps --width 400 --height 300".split()]
        subprocess.check_output([self.asked.build / "tests/synthetic/psfm-render-scene", *words])
        subprocess.check_output([self.asked.build / "tests/fuzz/psfm_make_seeds", self.folder / "seeds"])
        files = sorted(self.folder.glob("wall/images/*"))
        self.secrets = set().union(*map(self.secrets_of, files))
        self.photos = [file.read_bytes() for file in files]
        self.valid = valid_photographs(self.folder) + self.photos[:1]
        add = [self.psfm, "serve", "--session", self.folder / "first", "--role"]
        for role in ("owner", "send", "look"):
            out = subprocess.check_output([*add, role, "--add-user", role], text=True)
            self.tokens[role] = re.search(r"#token=([\w-]+)", out).group(1)
        self.begin("first")
        assert [self.put(0, data)[0] for data in self.photos] == ["201"] * 5
        assert set(self.settled(quiet_seconds=18).values()) == {"placed"}  # after 15 s models settle, which changes them
        self.end()

    def describe(self):
        """Valid requests: all of the API, and the pages; each with values that exist."""
        look = self.tokens["look"]
        number = int.from_bytes(self.server.ask("GET", API + "/scene", token=look)[2][4:8], "little")
        self.names = [[{"image": image} for image in range(6)], [{"sha256": sha(data)} for data in self.photos],
                      [{"first": min(edge[:2]), "second": max(edge[:2])}
                       for edge in self.server.json("/session", look)["edges"]],
                      self.server.json("/images/0", look)["observations"], [{"after": number - k} for k in range(3)]]
        paths = json.loads((Path(__file__).parents[3] / "docs/openapi.json").read_text())["paths"]
        # Few streams of events: the server keeps each for 15 s after its reader has gone, and 256 connections.
        self.operations = [(method.upper(), API + path + "?after={after}" * path.endswith("changes"))
                           for path, methods in paths.items() for method in methods
                           for _ in range(1 if path == "/events" else 12)]
        self.operations += [("GET", f"/{page}") for page in ("", "capture", "viewer.js", "style.css", "x")]

    def run(self):
        self.prepare()
        self.begin("requests")
        self.describe()
        start, before, count = time.monotonic(), self.state(), self.asked.requests
        self.fuzz_requests(range(count // 3), ("look", "none", "wrong"))
        if (after := self.state()) != before:
            self.found(f"changed by who may not: {before[:2]}, {after[:2]}")
        self.fuzz_requests(range(count // 3, count), ("owner", "send", "send", "look", "none", "wrong"))
        seconds = time.monotonic() - start
        self.settled()
        self.end()
        self.fuzz_photographs(self.asked.photographs)
        return seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    for name, default in (("requests", 2000), ("photographs", 200), ("seed", 1), ("threads", 4)):
        parser.add_argument(f"--{name}", type=int, default=default)
    asked, began = parser.parse_args(), time.monotonic()
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(asked.threads) as pool:
        fuzzer = Fuzzer(asked, Path(folder), pool)
        seconds = fuzzer.run()
    counts, looks = fuzzer.requests, fuzzer.photographs
    http, known = counts.pop("http", 0), looks["200"] + looks["201"]
    print(json.dumps({"requests": asked.requests, "share_that_is_http": http / max(1, asked.requests),
                      "statuses": counts, "requests_a_second": round(asked.requests / seconds, 1),
                      "photographs": asked.photographs, "share_of_a_known_kind": known / max(1, asked.photographs),
                      "statuses_and_states": looks, "findings": fuzzer.findings,
                      "seconds": round(time.monotonic() - began, 1)}, indent=1))
    return 1 if fuzzer.findings else 0


if __name__ == "__main__":
    sys.exit(main())
