"""A peer whose bodies stay where they are put, and that misbehaves from its third step on, as its argument says."""

import json
import os
import struct
import sys
import time
from pathlib import Path

MISDEED = sys.argv[1]
HELLO = json.loads((Path(__file__).parents[3] / "docs" / "toy_engine" / "hello.json").read_text())
HELLO |= {"engine": "rogue_peer", "contacts_at": "end"}
HELLO["capabilities"]["planar"] = False
if MISDEED == "other_protocol":
    HELLO["protocol"] = 2


def say(kind: int, body: bytes) -> None:
    os.write(1, struct.pack("<II", len(body), kind) + body)


def leave() -> None:
    os.write(2, b"out of contacts\n")
    os._exit(3)


def keep_busy() -> None:
    while True:
        pass


def stop_talking() -> None:
    os.close(1)
    time.sleep(3600)


INSTEAD = {
    "exit": leave,
    "busy": keep_busy,
    "closed": stop_talking,
    "silence": lambda: time.sleep(3600),
    "garbage": lambda: os.write(1, b"Warning: solver did not converge\n"),
    "huge": lambda: os.write(1, struct.pack("<II", 2**31, 3)),
    "error": lambda: say(4, b'{"message": "the solver gave up"}'),
    "kind": lambda: say(7, b""),
}
"""What it does instead of an answer."""
SPOILT = {
    "nan": (6, float("nan")),  # of the first body's position
    "clock": (0, 1e6),
    "count": (3, -1.0),
    "bodies": (5, 77.0),
    "short": (1, 2.0),
}
"""The place in the answer, and what stands there."""


def answer(reply: list[float], misbehaves: bool) -> None:
    if misbehaves and MISDEED in INSTEAD:
        INSTEAD[MISDEED]()
        return
    if misbehaves and MISDEED in SPOILT:
        place, number = SPOILT[MISDEED]
        reply[place] = number
    words = struct.pack(f"<{len(reply)}d", *reply)
    more = b"more" if misbehaves and MISDEED == "chatter" else b""
    os.write(1, struct.pack("<II", len(words), 3) + words + more)


def play() -> None:
    bodies, steps = {}, 0
    while header := sys.stdin.buffer.read(8):
        length, kind = struct.unpack("<II", header)
        body = sys.stdin.buffer.read(length)
        if kind == 1:
            say(1, json.dumps(HELLO).encode() if MISDEED != "no_json" else b"hello")
        elif kind == 2:
            say(2, b"{}")
        else:
            words = struct.unpack(f"<{length // 8}d", body)
            for k in range(int(words[3])):
                code, number, *rest = words[4 + 13 * k : 17 + 13 * k]
                if code == 1:
                    bodies[number] = [*rest[4:11], *(0.0,) * 6]
            blocks = int(words[1]) + 1 if words[2] else 1
            states = [x for _ in range(blocks) for number in sorted(bodies) for x in bodies[number]]
            steps += 1
            answer([0.0, len(bodies), blocks, 0, 0, *sorted(bodies), *states], steps >= 3)


play()
