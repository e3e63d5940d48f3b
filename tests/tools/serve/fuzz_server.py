#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 the psfm authors
# SPDX-License-Identifier: BSD-3-Clause
"""Requests and photographs, mutated from valid ones of every kind, against psfm serve: it lives, answers within 30 s
and with no 5xx but 503 and 507, and who may not write or read does not. What is found is in ./FINDING-n.bin.
usage: fuzz_server.py BUILD [--requests N] [--photographs N] [--seed N] [--threads N]
By hand: fuzz_server.py build/release --requests 100000 --photographs 10000"""
import argparse
import base64
import contextlib
import json
import re
import shutil
import signal
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
from types import SimpleNamespace

from server import API, Server, sha

HANG_SECONDS = 30
BATCH = 500  # requests until the server is looked at, photographs until it gets its first session again
NO_HTTP = (b"this is no request that can be understood", b"the header of the request is too long")
NUMBERS = [b"-1", b"0", b"1", b"2147483647", b"2147483648", b"4294967295", b"4294967296", b"9007199254740993", b"%31",
           b"9223372036854775808", b"18446744073709551615", b"18446744073709551616", b"1e309", b"NaN", b"9" * 400,
           b"0x10", b"+1", b"1.5", b"00000000001", b""]
ESCAPES = [b"%00", b"%2e%2e/", b"../", b"..%2f..%2f", b"%5c..%5c", b"\\", b"%", b"%z", b"%ff%fe", b"//", b"/", b"/./",
           b"%0d%0aX:%20y", b"\xc3\xa9", b"%25", b"?", b"#", b"&", b"=", b"\0", b"%c0%ae%c0%ae/", b"a" * 300, b";a=b",
           b"../" * 100, b"%41" * 2000, b"a/" * 3000, b"a" * 9000]
METHODS = b"GET HEAD POST PUT PATCH DELETE OPTIONS TRACE CONNECT PROPFIND get M-SEARCH GETGETGET".split()
HEADERS = (b"Content-Length Content-Length Transfer-Encoding Transfer-Encoding Upload-Offset Upload-Length Range Expect "
           b"Connection Upgrade Accept-Encoding Content-Encoding Content-Type Host Origin Sec-Fetch-Site Cookie "
           b"Authorization Last-Event-ID X-Forwarded-Proto If-None-Match X\xff").split()
VALUES = [b"chunked", b"gzip, chunked", b"identity", b"xchunked", b"gzip", b"bytes=0-0", b"bytes=-1", b"100-continue",
          b"bytes=18446744073709551615-", b"bytes=" + b"0-0," * 500, b"close", b"keep-alive", b"upgrade", b"h2c",
          b"websocket", b"http://evil.example", b"null", b"127.0.0.1", b"[::1", b"]", b"a:b:c", b"cross-site",
          b"same-origin", b"psfm_token", b"psfm_token=", b"a=b; psfm_token=x", b";" * 500, b"Bearer", b"Basic Og==",
          b"Bearer " + b"x" * 4000, b"Bearer \xff", b"application/json", b"application/offset+octet-stream", b"1-1",
          b"1700000000-0", b"https", b'"0"', b"\xff", b"x" * 7000, b"x" * 9000, b"x" * 100000]
BODIES = [b"", b"[" * 4000, b'{"token":' * 400, b'{"token":1}', b'{"token":"\\u0000"}', b"\0" * 5000, b"x" * 100000,
          b'{"token":"\\ud800"}', b'{"token":"a\\r\\nSet-Cookie: b=c"}', b'{"token":"\xff"}', b"0\r\n\r\n"]
# 72 x 64 pixels by libheif 1.15: none of the programs that are there for sure writes this kind.
AVIF = base64.b64decode(
    "AAAAHGZ0eXBhdmlmAAAAAGF2aWZtaWYxbWlhZgAAAOptZXRhAAAAAAAAACFoZGxyAAAAAAAAAABwaWN0AAAAAAAAAAAAAAAAAAAAAA5waXRt"
    "AAAAAAABAAAAImlsb2MAAAAAREAAAQABAAAAAAEOAAEAAAAAAAAAlwAAACNpaW5mAAAAAAABAAAAFWluZmUCAAAAAAEAAGF2MDEAAAAAamlw"
    "cnAAAABLaXBjbwAAABNjb2xybmNseAACAAIABoAAAAAMYXYxQ4EADAAAAAAUaXNwZQAAAAAAAABIAAAAQAAAABBwaXhpAAAAAAMICAgAAAAX"
    "aXBtYQAAAAAAAAABAAEEgYIDhAAAAJ9tZGF0EgAKCRgZY/7BAgIGhDKHAUVgA0000KC4cBSNxO6UY2vgf9tX5ZMnaxr+fbQS5AWIMMA/Xwf0"
    "ElmA0/jDHh26YQ1SsYz4PXRwwcYEQnqDiyONuR559DvflPSqKPR8G27/EZKOrX+qzvdhy3SrU0Z0SEI4j/MWIJwys5ALfU4zxremcfiqve2z"
    "1jQ2cPP8n1ZOpP/+qO1jKQ==")


def wrong_token(rng, right):
    return rng.choice([right[:-3], right[::-1], right * 2, "x" * 43, "-", right[:20] + "A" * 23, "a" * 2000])


def credentials(rng, token):
    return rng.choice([(b"Authorization", b"Bearer " + token), (b"Cookie", b"a=b; psfm_token=" + token)])


def valid_request(rng, world, roles):
    """@return the lines of its head, its body"""
    method, path = rng.choice(world.operations)
    names = {name: value for group in world.names for name, value in rng.choice(group).items()}
    role, body, more = rng.choice(roles), b"", []
    token = (world.tokens.get(role) or wrong_token(rng, world.tokens["send"])).encode()
    target = path.format(**names).encode()
    if path.endswith("changes"):
        target += b"?after=%d" % max(0, world.number - rng.randrange(3))
    if method == "POST":
        more, body = [(b"Content-Type", b"application/json")], b'{"token":"' + token + b'"}'
    if method in ("PUT", "PATCH"):
        body = rng.choice(world.payloads)
        target = f"{API}/photographs/{sha(body)}?name=IMG_{rng.randrange(9)}.jpg".encode()
    if method == "PATCH":
        start, end = rng.choice([0, 0, len(body) // 3]), rng.choice([len(body), len(body) // 3])
        more = [(b"Upload-Offset", b"%d" % start), (b"Upload-Length", b"%d" % len(body)),
                (b"Content-Type", b"application/offset+octet-stream")]
        body = body[start:max(start + 1, end)]
    headers = [(b"Host", world.server.host.encode()), *more]
    headers += [credentials(rng, token)] if role != "none" else []
    headers += [(b"Content-Length", b"%d" % len(body))] if body else []
    headers += [(b"Accept-Encoding", b"gzip")] if rng.random() < 0.3 else []
    return [method.encode() + b" " + target + b" HTTP/1.1", *(name + b": " + value for name, value in headers)], body


def replaced(rng, pattern, values, data):
    matches = list(re.finditer(pattern, data))
    if not matches:
        return data
    match = rng.choice(matches)
    return data[:match.start()] + rng.choice(values) + data[match.end():]


def odd_bytes(rng, data):
    """Flipped, inserted, removed or repeated; more of them in front, where headers are."""
    at, count = int(len(data) * rng.random() ** 2), rng.choice([1, 1, 2, 4, 16, 64])
    part, rest = data[at:at + count], data[at + count:]
    flipped = bytes(byte ^ (1 << rng.randrange(8)) for byte in part)
    return data[:at] + rng.choice([flipped, part + rng.randbytes(count), b"", part * rng.choice([2, 3, 20])]) + rest


def with_header(lines, name, value):
    return [line for line in lines if not line.startswith(name + b":")] + [name + b": " + value]


def odd_lines(rng, lines):
    k, how = rng.randrange(1, len(lines) + 1), rng.choice(["order", "twice", "drop", "many", "case"])
    if how == "order":
        return [lines[0], *rng.sample(lines[1:], len(lines) - 1)]
    if how == "many":
        return lines + [b"X-%d: y" % i for i in range(rng.choice([50, 200, 1000]))]
    one = lines[k:k + 1]
    return lines[:k] + {"twice": one * 2, "drop": [], "case": [line.lower() for line in one]}[how] + lines[k + 1:]


def odd_target(rng, line, how):
    method, rest = line.split(b" ", 1)
    target, version = rest.rsplit(b" ", 1)
    if how == "method":
        method = rng.choice(METHODS)
        version = rng.choice([b"HTTP/1.0", b"HTTP/2.0", b""]) if rng.random() < 0.1 else version
    elif how == "query":
        value = rng.choice([*NUMBERS, *ESCAPES, rng.randbytes(20), b"%ff" * 100])
        target += rng.choice([b"?", b"&"]) + rng.choice([b"name=", b"after=", b"token=", b"=", b"%00"]) + value
    else:
        at = rng.randrange(1, len(target) + 1) if target else 0
        target = target[:at] + rng.choice(ESCAPES) + target[at + rng.choice([0, 0, 1, 5]):]
    return b" ".join([method, target, version])


def odd_body(rng, lines, body):
    how = rng.choice(["other", "truncated", "mutated", "named", "chunks"])
    if how == "chunks":
        size = rng.choice([7, 100, 1000])
        parts = [body[i:i + size] for i in range(0, len(body), size)]
        lines = [line for line in lines if not line.startswith(b"Content-Length:")] + [b"Transfer-Encoding: chunked"]
        return lines, b"".join(b"%x\r\n%b\r\n" % (len(part), part) for part in parts) + b"0\r\n\r\n"
    others = {"other": rng.choice(BODIES), "truncated": body[:rng.randrange(len(body) + 1)]}
    body = others.get(how, odd_bytes(rng, body))
    if how == "named" and lines[0].startswith(b"PUT"):  # by its right name it goes on to what looks at its kind
        lines = [f"PUT {API}/photographs/{sha(body)} HTTP/1.1".encode(), *lines[1:]]
    return with_header(lines, b"Content-Length", b"%d" % len(body)) if rng.random() < 0.75 else lines, body


def fuzzed_request(rng, world, roles):
    """Most mutations leave HTTP as it is, for the routes; the others are for its parser."""
    lines, body = valid_request(rng, world, roles)
    kinds = ["number", "target", "query", "header", "lines", "method", "body", "token", "bytes"]
    hows = rng.choices(kinds, [4, 2, 3, 4, 3, 3, 4, 3, 3], k=rng.randrange(5))
    for how in hows:
        if how == "number":  # not those of the address, nor of a hash or the version
            lines = replaced(rng, rb"(?<=[/= ])\d+(?=[/ \r&?])", NUMBERS, b"\r\n".join(lines)).split(b"\r\n")
        elif how in ("target", "query", "method"):
            lines = [odd_target(rng, lines[0], how), *lines[1:]]
        elif how == "header":
            name, value = rng.choice(HEADERS), rng.choice(VALUES + NUMBERS)
            lines = with_header(lines, name, value) if rng.random() < 0.7 else [*lines, name + b": " + value]
        elif how == "lines":
            lines = odd_lines(rng, lines)
        elif how == "body":
            lines, body = odd_body(rng, lines, body)
        elif how == "token":
            token = rng.choice([world.tokens.get(rng.choice(roles)), wrong_token(rng, world.tokens["look"])]) or ""
            lines = with_header(lines, *credentials(rng, token.encode()))
    raw = b"\r\n".join(lines) + b"\r\n\r\n" + body
    for _ in range(hows.count("bytes")):
        other = b"\r\n".join(valid_request(rng, world, roles)[0]) + b"\r\n\r\n"
        cut = rng.randrange(len(raw) + 1)
        raw = rng.choice([odd_bytes(rng, raw), odd_bytes(rng, raw), raw + other, raw[:cut] + other[cut % len(other):],
                          raw.replace(b"\r\n", b"\n"), raw[:cut]])
    return raw


def valid_photographs(world):
    """By name: what tests/fuzz/make_seeds.cpp encodes, and kinds that it does not."""
    subprocess.run([world.build / "tests/fuzz/psfm_make_seeds", world.folder / "seeds"], check=True)
    files = [file for name in ("photo", "heif") for file in sorted((world.folder / "seeds" / name).iterdir())]
    photos = {file.name: file.read_bytes() for file in files if file.name != "no_picture"}
    width, height, paint = 72, 64, [Random(i).randbytes(4) for i in range(72)]
    pixels = [paint[y // 8 * 9 + x // 8] for y in range(height) for x in range(width)]
    flat = [b"".join(pixel[:channels] for pixel in pixels) for channels in range(5)]
    size = b"%d %d\n" % (width, height)
    rows = b"".join(b"\0" + flat[4][i:i + 4 * width] for i in range(0, len(flat[4]), 4 * width))
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
    alpha = b"".join(struct.pack(">I", len(data)) + name + data + bytes(4) for name, data in chunks)
    index = b"\xff\xe2\0\x20MPF\0MM\0*\0\0\0\x08\0\x01\xb0\0\0\x07\0\0\0\x040100\0\0\0\0"  # of several pictures (CIPA DC-007)
    return photos | {
        "alpha.png": with_right_checksums(b"\x89PNG\r\n\x1a\n" + alpha), "phone.avif": AVIF, "gps.jpg": world.photos[0],
        "grey.pgm": b"P5\n# grey\n" + size + b"255\n" + flat[1], "deep.ppm": b"P6 " + size + b"65535\n" + flat[3] * 2,
        "text.ppm": b"P3\n" + size + b"255\n" + b" ".join(b"%d" % value for value in flat[3]),
        "core.bmp": struct.pack("<2sIIIIHHHH", b"BM", 0, 0, 26, 12, width, height, 1, 24) + flat[3],
        "stereo.mpo": photos["exif.jpg"][:2] + index + photos["exif.jpg"][2:] + photos["plain.jpg"]}


def with_right_checksums(data):
    """So that what is mutated of a PNG gets past its checksums."""
    out, at = bytearray(data), 8
    while (end := at + 8 + int.from_bytes(out[at:at + 4], "big")) + 4 <= len(out):
        out[end:end + 4] = struct.pack(">I", zlib.crc32(out[at + 4:end]))
        at = end + 4
    return bytes(out)


def odd_part(rng, data):
    """A length, size or offset beside the name of a chunk, box or marker, or the part between two such names."""
    names = [match.start() for match in re.finditer(rb"[A-Za-z]{3}[A-Za-z0-9 ]|\xff[\xc0-\xfe]", data)] or [0]
    at, end = sorted((rng.choice(names), rng.choice(names)))
    how, width = rng.randrange(4), rng.choice([1, 2, 4, 4, 8])
    if how < 2:
        other = rng.choice(names)
        return data[:at] + rng.choice([b"", data[at:end] * 2, data[other:other + end - at]]) + data[end:]
    at = max(0, rng.choice(names) + rng.choice([-4, 2, 4, 8, 12])) if how == 2 else int(len(data) * rng.random() ** 2)
    value = rng.choice([0, 1, 2, 1 << 7, 1 << 15, 1 << 31, 1 << 63, len(data)]) - rng.randrange(2)
    return data[:at] + (value % (1 << 8 * width)).to_bytes(width, rng.choice(["big", "little"])) + data[at + width:]


def fuzzed_photograph(rng, photos):
    data = rng.choice(photos)
    for _ in range(rng.randrange(1, 5)):
        how, other = rng.randrange(10), rng.choice(photos)
        if how == 0:
            data = data[:rng.randrange(len(data) + 1)]
        elif how == 1:
            data = data[:rng.randrange(len(data) + 1)] + other[rng.randrange(len(other)):]
        elif how < 5 and data[:1] == b"P":
            data = replaced(rng, rb"\d+", NUMBERS, data[:40]) + data[40:]
        else:
            data = odd_bytes(rng, data) if how < 5 else odd_part(rng, data)
    return with_right_checksums(data) if data[1:4] == b"PNG" and rng.random() < 0.8 else data


def found(world, why, data=b""):
    world.findings += 1
    Path(f"FINDING-{world.findings}.bin").write_bytes(data)
    print(f"FINDING-{world.findings}.bin: {why}: {data[:3000]!r}", file=sys.stderr, flush=True)


def exchange(world, data, address):
    """@return all that is answered, of events the beginning; whether that took too long"""
    end, answer = time.monotonic() + HANG_SECONDS, b""
    with socket.socket() as connection:
        # Closed at once: a stream of events that nobody reads would count as a connection until it is written to.
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        connection.settimeout(HANG_SECONDS)
        connection.bind((address, 0))
        with contextlib.suppress(OSError):  # refused before all was sent: there is an answer
            connection.connect(("127.0.0.1", world.server.port))
            connection.sendall(data)
            connection.shutdown(socket.SHUT_WR)  # else the rest of half a request would be waited for
        try:
            while (chunk := connection.recv(1 << 18)) and b"text/event-stream" not in chunk:
                answer += chunk
                connection.settimeout(max(0.001, end - time.monotonic()))
        except socket.timeout:
            return answer, True
        except OSError:
            return answer, False
    return answer + chunk, False


def ask(world, number, roles, is_powerless):
    """@return the request, its status, whether it was HTTP, what is wrong"""
    data = fuzzed_request(Random(world.seed + number), world, roles)
    # Ten wrong tokens a minute are borne from an address, and then nothing at all.
    address = f"127.{1 + number // 250000}.{number // 1000 % 250}.{1 + number // 4 % 250}"
    answer, hangs = exchange(world, data, address)
    heads = re.findall(rb"HTTP/1\.1 (?!100)(\d{3}) .*?\r\n(.*?)\r\n\r\n", answer, re.DOTALL)
    wrong = [f"no answer after {HANG_SECONDS} s"] if hangs else []
    wrong += [f"status {status}" for status, _ in heads if status[:1] == b"5" and status not in (b"503", b"507")]
    is_told = any(status in (b"200", b"201") and b"Content-Type: text/" not in head for status, head in heads)
    if (is_told or b"text/event-stream" in answer) and not any(token.encode() in data for token in world.tokens.values()):
        wrong.append(f"told without a token: {answer[:500]!r}")
    texts = [zlib.decompressobj(31).decompress(answer[one.start():]) for one in re.finditer(b"\x1f\x8b\x08\0\0", answer)]
    if is_powerless and any(secret in text for text in [answer, *texts] for secret in world.secrets):
        wrong.append("an original or a position was told")
    is_http = bool(heads) and not any(words in answer[:2000] for words in NO_HTTP)
    return data, heads[0][0].decode() if heads else "none", is_http, wrong


def look_after(world, suspects):
    """The server lives and answers; if not, one of these did it."""
    status = None
    with contextlib.suppress(OSError):
        status = world.server.ask("GET", API + "/session", token=world.tokens["owner"])[0]
    if world.server.process.poll() is not None or status != 200:
        for data in suspects:
            found(world, f"server ended ({world.server.process.poll()}) or mute ({status}), perhaps by this", data)
        world.server.stop()
        sys.exit(f"the server is gone: {world.server.errors}")


def fuzz_requests(world, numbers, roles, is_powerless, counts):
    for batch in (numbers[i:i + BATCH] for i in range(0, len(numbers), BATCH)):
        answers = list(world.pool.map(lambda number: ask(world, number, roles, is_powerless), batch))
        for data, status, is_http, wrong in answers:
            counts.update([status] + ["http"] * is_http)
            for why in wrong:
                found(world, why, data)
        look_after(world, [data for data, status, _, _ in answers if status == "none"])


def state_of(world):
    session = world.server.json("/session", world.tokens["owner"])
    files = [*world.session.glob("photographs/**/*"), world.session / "uploads.log", world.session / "users.json"]
    images = [(image["name"], image["title"], image["state"]) for image in session["image_list"]]
    return session["counts"], images, {file: file.read_bytes() for file in files if file.is_file()}


def settled(world, seconds=900):
    """Every photograph has been looked at, and for three seconds nothing happens. @return their states, by hash"""
    quiet, before, end = 0, None, time.monotonic() + seconds
    while quiet < 3 and time.monotonic() < end:
        time.sleep(1)
        mine = [world.server.json("/photographs", world.tokens[role])["photographs"] for role in ("owner", "send")]
        states = {one["sha256"]: one["state"] for one in sum(mine, [])}
        now = state_of(world)[0]
        quiet = quiet + 1 if now == before and "queued" not in states.values() else 0
        before = now
    if quiet < 3:
        found(world, f"no rest in {seconds} s: {before}, {Counter(states.values())}")
    return states


def put(world, number, data):
    """@return status, once the server does not say any more that it has enough to look at; whether that is wrong"""
    token = world.tokens[("owner", "send")[number % 2]]
    head = (f"PUT {API}/photographs/{sha(data)}?name={number} HTTP/1.1\r\nHost: {world.server.host}\r\n"
            f"Authorization: Bearer {token}\r\nContent-Length: {len(data)}\r\n\r\n")
    while (answer := exchange(world, head.encode() + data, "127.0.0.1"))[0][9:12] == b"429":
        time.sleep(0.5)
    status = answer[0][9:12].decode() or "none"
    return status, answer[1] or status not in ("200", "201", "413", "415", "503", "507")


def fuzz_photographs(world, total, counts):
    valid = list(valid_photographs(world).values())
    for start in range(0, total, BATCH):
        begin(world, f"photographs-{start}")  # anew, since the API takes none out again
        numbers = range(start, min(start + BATCH, total))
        made = valid + [fuzzed_photograph(Random(world.seed - 1 - number), valid) for number in numbers]
        answers = list(world.pool.map(lambda number: put(world, number, made[number]), range(len(made))))
        look_after(world, made)
        states = settled(world)
        for k, (data, (status, is_wrong)) in enumerate(zip(made, answers)):
            if is_wrong or (k < len(valid) and states.get(sha(data)) == "rejected"):
                found(world, f"photograph: {status}, {states.get(sha(data))}", data)
            counts.update([status, states.get(sha(data), "no photograph")] * (k >= len(valid)))
        for image in range(0, len(states), 10):
            status = world.server.ask("GET", f"{API}/images/{image}/thumbnail", token=world.tokens["look"])[0]
            if status not in (200, 404):
                found(world, f"thumbnail of image {image}: {status}")
        end(world)


def begin(world, name):
    """A server on a copy of the first session."""
    world.session = world.folder / name
    shutil.copytree(world.folder / "first", world.session)
    world.server = Server(world.build, world.session)
    settled(world)


def end(world):
    if (code := world.server.stop()) != 0:
        found(world, f"the server ended with {code}: {world.server.errors}")
    words = [world.build / "psfm", "check", "--session", world.session]
    if (done := subprocess.run(words, capture_output=True, text=True, check=False)).returncode:
        found(world, f"psfm check: {done.returncode}: {done.stdout}{done.stderr}")


def secrets_of(world, file):
    """Parts of a photograph's EXIF data and picture, and its position to 1 m."""
    data = file.read_bytes()
    exif, scan = data.index(b"Exif\0\0"), data.rindex(b"\xff\xda")
    places = [*range(exif, exif + int.from_bytes(data[exif - 2:exif], "big") - 24, 8), *range(scan + 50, len(data) - 24, 4000)]
    parts = [data[at:at + 24] for at in places if len(set(data[at:at + 24])) > 6]
    out = subprocess.run([world.build / "psfm", "decode-photograph", file], check=True, capture_output=True).stdout
    position = json.JSONDecoder().raw_decode(out[8:].decode("latin-1"))[0]["gps"]
    return parts + [f"{degrees:.7f}"[:-2].encode() for degrees in position[:2]]


def prepare(world):
    """A session in which five photographs are placed, and what valid requests are made of."""
    render = [world.build / "tests/synthetic/psfm-render-scene", "--scene", "wall", "--images", "5", "--gps", "--width"]
    for name, size in (("wall", ["400", "--height", "300"]), ("tiny", ["96", "--height", "72"])):
        subprocess.run([*render, *size, world.folder / name], check=True, stdout=subprocess.DEVNULL)
    files = sorted(world.folder.glob("wall/images/*"))
    world.photos = [file.read_bytes() for file in files]
    world.payloads = [file.read_bytes() for file in sorted(world.folder.glob("tiny/images/*"))]
    world.secrets = [secret for file in files for secret in secrets_of(world, file)]
    world.session = world.folder / "first"
    add = [world.build / "psfm", "serve", "--session", world.session, "--role"]
    for role in ("owner", "send", "look"):
        out = subprocess.run([*add, role, "--add-user", role], check=True, capture_output=True, text=True).stdout
        world.tokens[role] = re.search(r"#token=([\w-]+)", out).group(1)
    world.server = Server(world.build, world.session)
    for data in world.photos:
        assert put(world, 0, data)[0] == "201"
    assert set(settled(world).values()) == {"placed"}
    end(world)


def describe(world):
    """Valid requests: all of the API, and the pages; each with values that exist."""
    seen = world.server.json("/images/0", world.tokens["look"])["observations"][:50]
    edges = world.server.json("/session", world.tokens["look"])["edges"]
    world.number = int.from_bytes(world.server.ask("GET", API + "/scene", token=world.tokens["look"])[2][4:8], "little")
    world.names = [[{"image": image} for image in range(6)], [{"sha256": sha(data)} for data in world.photos + world.payloads],
                   [{"first": min(edge[:2]), "second": max(edge[:2])} for edge in edges],
                   [{"cluster": one["cluster"], "slot": one["slot"]} for one in seen]]
    paths = json.loads((Path(__file__).parents[3] / "docs/openapi.json").read_text())["paths"]
    operations = [(method.upper(), API + path) for path, methods in paths.items() for method in methods]
    pages = [("GET", page) for page in ("/", "/capture", "/viewer.js", "/capture.js", "/style.css", "/favicon.ico")]
    # Few streams of events: the server keeps each for 15 s after its reader has gone, and 256 connections in all.
    world.operations = 6 * [one for one in operations if one[1] != API + "/events"] + [("GET", API + "/events")] + pages


def fuzz(world, asked, counts):
    """@return how long the requests took"""
    prepare(world)
    begin(world, "requests")
    describe(world)
    start, before, powerless = time.monotonic(), state_of(world), asked.requests // 3
    fuzz_requests(world, range(powerless), ("look", "none", "wrong"), True, counts)
    if (after := state_of(world)) != before:
        found(world, f"changed by who may not: {before[:2]}, {after[:2]}")
    everyone = ("owner", "send", "send", "look", "none", "wrong")
    fuzz_requests(world, range(powerless, asked.requests), everyone, False, counts)
    seconds = time.monotonic() - start
    settled(world)
    end(world)
    return seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    for name, default in (("requests", 2000), ("photographs", 200), ("seed", 1), ("threads", 4)):
        parser.add_argument(f"--{name}", type=int, default=default)
    asked, began, counts, looks = parser.parse_args(), time.monotonic(), Counter(), Counter()
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(asked.threads) as pool:
        world = SimpleNamespace(build=asked.build, folder=Path(folder), seed=asked.seed * 10**9, pool=pool, tokens={},
                                server=None, findings=0)
        try:
            seconds = fuzz(world, asked, counts)
            fuzz_photographs(world, asked.photographs, looks)
        finally:
            if world.server and world.server.process.poll() is None:
                world.server.stop(signal.SIGKILL)
    http, known = counts.pop("http", 0), looks["201"] + looks["200"]
    print(json.dumps({
        "requests": asked.requests, "share_that_is_http": round(http / max(1, asked.requests), 3), "statuses": counts,
        "requests_a_second": round(asked.requests / seconds, 1), "photographs": asked.photographs,
        "share_of_a_known_kind": round(known / max(1, asked.photographs), 3), "statuses_and_states": looks,
        "findings": world.findings, "seconds": round(time.monotonic() - began, 1)}, indent=1))
    return 1 if world.findings else 0


if __name__ == "__main__":
    sys.exit(main())
