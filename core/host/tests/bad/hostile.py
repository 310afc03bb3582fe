"""A tracker that says to its host what no plugin should: the name of one misdeed is its argument. It speaks as
core/host/src/wire.rs describes, leaves every point where it is, and does its misdeed in frame 2."""

import array
import fcntl
import json
import mmap
import os
import socket
import struct
import sys
import termios
import threading
import time

HOST = socket.socket(fileno=0)


def say(line):
    HOST.sendall(line if isinstance(line, bytes) else (json.dumps(line) + "\n").encode())


def done(rows=2, **at):
    """The usual answer, with some of it said otherwise."""
    columns = {"id": 4096, "x": 8192, "y": 12288, "status": 16384, **at}
    table = {"rows": rows, "at": {name: place for name, place in columns.items() if place is not None}}
    return {"m": "done", "code": 0, "tables": {"honami.points/1": table}}


def refused(deed):
    """The words of the system when it does not let this process do something."""
    try:
        deed()
        return "nobody minds"
    except OSError as error:
        return os.strerror(error.errno)


def flicker(memory):
    """Another position every time that somebody looks, of which one is none."""

    def turn():
        while True:
            for value in (2.0, float("nan"), float("inf")):
                struct.pack_into("<ff", memory, 8192, value, value)

    threading.Thread(target=turn, daemon=True).start()


def shrink(files, size):
    """Whether the memory for answers can be made smaller, and that of the host be written."""
    return [
        refused(lambda: os.ftruncate(files[1], size)),
        refused(lambda: mmap.mmap(files[0], 4096)),
        refused(lambda: os.pwrite(files[0], b"x", 0)),
    ]


def answer_unread(usual):
    """Answers whatever comes, and reads nothing of it."""
    unread, said = array.array("i", [0]), 0
    say(usual)
    while True:
        fcntl.ioctl(HOST, termios.FIONREAD, unread)
        if unread[0] > said:
            said = unread[0]
            say(usual)


def main(misdeed):
    first, files, _, _ = socket.recv_fds(HOST, 4096, 2)
    memory = mmap.mmap(files[1], 0)
    asks = HOST.makefile("r")
    ask = json.loads(first)
    ids = [3, 1]
    frame = 0
    while ask:
        answer = {"m": "done"}
        if ask["m"] == "push":
            for at, kind, values in ((4096, "II", ids), (8192, "ff", [1, 2]), (12288, "ff", [1, 1.5])):
                struct.pack_into("<" + kind, memory, at, *values)
            struct.pack_into("<BB", memory, 16384, 1, 1)
            answer = done()
            if frame == 2:
                say_otherwise(misdeed, memory, files, answer)
                answer = None
            frame += 1
        if answer:
            say(answer)
        line = asks.readline()
        ask = json.loads(line) if line else None


def say_otherwise(misdeed, memory, files, usual):
    if misdeed == "--flicker":
        flicker(memory)
    wrong = {
        "--far-column": done(x=1 << 40),
        "--last-byte": done(x=(1 << 64) - 4),
        "--header-column": done(x=0),
        "--overlap": done(y=8192),
        "--beyond": done(rows=1 << 18),
        "--huge-rows": done(rows=(1 << 64) - 1),
        "--more-than-memory": done(rows=1 << 60),
        "--negative-rows": done(rows=-1),
        "--no-column": done(x=None),
        "--other-table": {**usual, "tables": {"honami.dendrogram/1": {"rows": 0, "at": {}}}},
        "--no-table": {"m": "done", "code": 0},
        "--other-word": {"m": "hello"},
        "--refuses": {"m": "refused", "kind": "unusable", "why": "no more"},
        "--deep": b"[" * 100_000 + b"\n",
        "--garbage": bytes(range(1, 256)) + b"\n",
        "--number": b"1e999\n",
        "--empty": b"\n",
        "--flicker": usual,
        "--fault": {**usual, "faults": ["\033[31mit is\033[0m all wrong"]},
    }
    if misdeed in wrong:
        say(wrong[misdeed])
    elif misdeed == "--twice":
        say((json.dumps(usual) + "\n" + json.dumps(usual) + "\n").encode())
    elif misdeed == "--later":
        chatter = json.dumps({"m": "log", "level": 0, "text": "on and on"}) + "\n"
        say((json.dumps(usual) + "\n" + 300 * chatter + json.dumps(usual) + "\n").encode())
    elif misdeed == "--deaf":
        answer_unread(usual)
    elif misdeed == "--endless":
        while True:
            say(b"x" * (1 << 16))
    elif misdeed == "--half":
        say(b'{"m":')
        time.sleep(1000)
    elif misdeed == "--half-and-gone":
        say(b'{"m":')
        os._exit(0)
    elif misdeed == "--chatter":
        while True:
            say({"m": "log", "level": 0, "text": "on and on"})
    elif misdeed == "--hangs-up":
        HOST.shutdown(socket.SHUT_RDWR)
        time.sleep(1000)
    elif misdeed == "--shrinks":
        say({"m": "done", "code": -1, "text": ", ".join(shrink(files, 0))})
    elif misdeed == "--grows":
        os.ftruncate(files[1], 1 << 30)
        say(done(rows=1 << 22, id=1 << 29, x=1 << 28, y=1 << 27, status=1 << 26))


main(sys.argv[1])
