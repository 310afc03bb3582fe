#!/usr/bin/env python3
"""A slow link between two network namespaces: rate, one-way delay, a queue that drops what does not fit, loss.

Opens a TUN device in each namespace and carries packets between them, both ways alike. Prints `ready` when both
are up, and on SIGTERM or SIGINT one line of JSON with what it has carried and dropped each way.
"""

import argparse
import ctypes
import fcntl
import json
import os
import random
import select
import signal
import struct
import subprocess
import time
from collections import deque

CLONE_NEWNET = 0x40000000
TUNSETIFF = 0x400454CA
IFF_TUN_NO_PI = 0x0001 | 0x1000
MTU = 1400


def enter(namespace_fd):
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.setns(namespace_fd, CLONE_NEWNET) != 0:
        raise OSError(ctypes.get_errno(), "cannot enter the network namespace")


def open_end(namespace, device, here, there, congestion):
    """Descriptor of a TUN device inside a namespace, with its addresses set."""
    home = os.open("/proc/self/ns/net", os.O_RDONLY)
    other = os.open(f"/run/netns/{namespace}", os.O_RDONLY)
    enter(other)
    try:
        tun = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
        fcntl.ioctl(tun, TUNSETIFF, struct.pack("16sH22x", device.encode(), IFF_TUN_NO_PI))
        ip = ["ip", "link", "set"]
        subprocess.run([*ip, "lo", "up"], check=True)
        subprocess.run(["ip", "addr", "add", here, "peer", there, "dev", device], check=True)
        subprocess.run([*ip, device, "mtu", str(MTU), "up"], check=True)
        if congestion:
            route = ["ip", "route", "replace", there, "dev", device, "congctl", congestion]
            subprocess.run(route, check=True)
    finally:
        enter(home)
        os.close(home)
        os.close(other)
    return tun


class Way:
    """One direction: packets leave one after another at the rate, and arrive a delay later."""

    def __init__(self, source, target, args, seed):
        self.source, self.target = source, target
        self.rate = args.mbit * 1e6 / 8
        self.delay, self.queue, self.loss = args.delay_ms / 1e3, args.queue, args.loss
        self.random = random.Random(seed)
        self.free_at = 0.0
        self.on_way = deque()
        self.counts = {"packets": 0, "bytes": 0, "dropped": 0}

    def take(self):
        """Takes what the source has; drops what does not fit into the queue, or is lost."""
        while True:
            try:
                packet = os.read(self.source, 65536)
            except BlockingIOError:
                return
            now = time.monotonic()
            waiting = max(0.0, self.free_at - now) * self.rate
            if waiting + len(packet) > self.queue or self.random.random() < self.loss:
                self.counts["dropped"] += 1
                continue
            self.free_at = max(self.free_at, now) + len(packet) / self.rate
            self.on_way.append((self.free_at + self.delay, packet))
            self.counts["packets"] += 1
            self.counts["bytes"] += len(packet)

    def deliver(self):
        """Hands over what has arrived; returns when the next packet arrives, or None."""
        while self.on_way:
            due, packet = self.on_way[0]
            if due > time.monotonic():
                return due
            self.on_way.popleft()
            try:
                os.write(self.target, packet)
            except OSError:
                self.counts["dropped"] += 1
        return None


def carry(ways):
    sources = [way.source for way in ways]
    while True:
        due = [at for at in (way.deliver() for way in ways) if at is not None]
        timeout = max(0.0, min(due) - time.monotonic()) if due else None
        select.select(sources, [], [], timeout)
        for way in ways:
            way.take()


def main():
    args = argparse.ArgumentParser(description=__doc__)
    args.add_argument("--namespaces", nargs=2, required=True, metavar=("CLIENT", "SERVER"))
    args.add_argument("--addresses", nargs=2, required=True, metavar=("CLIENT", "SERVER"))
    args.add_argument("--device", default="wan0")
    args.add_argument("--mbit", type=float, required=True, help="rate each way, Mbit/s")
    args.add_argument("--delay-ms", type=float, required=True, help="one-way delay")
    args.add_argument("--queue", type=int, default=64 * 1024, help="bytes that may wait each way")
    args.add_argument("--congestion", help="TCP's congestion control, as Linux calls it")
    args.add_argument("--loss", type=float, default=0.0, help="part of the packets that is lost, 0 to 1")
    args = args.parse_args()

    def stop(*_):
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, stop)
    ends = [
        open_end(namespace, args.device, here, there, args.congestion)
        for namespace, here, there in zip(args.namespaces, args.addresses, reversed(args.addresses))
    ]
    up, down = Way(ends[0], ends[1], args, 1), Way(ends[1], ends[0], args, 2)
    print("ready", flush=True)
    try:
        carry([up, down])
    except KeyboardInterrupt:
        pass
    print(json.dumps({"up": up.counts, "down": down.counts}), flush=True)


if __name__ == "__main__":
    main()
