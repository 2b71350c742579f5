"""Strangers at a listener: thousands of connections from many addresses, all in one process, as a seed draws them."""

import collections
import errno
import heapq
import os
import select
import socket
import struct
import time

from listeners import HTTP, TLS

ADDRESSES = [f"127.0.0.{last}" for last in range(1, 41)]
# In a burst at most, and how long one takes.
BURST, BURST_S = 250, 0.05
# Places that are left to clients, of those that speakers may take.
LEFT = 8
PIECE = 65536


def drip(listener, draw):
    """The longest half, a byte a second."""
    for byte in max(listener.halves, key=len):
        yield 1.0, bytes([byte])


def hasty(listener, draw, pause_s=0.5):
    received = yield 0.0, listener.hello
    while True:
        received = yield pause_s, listener.request(received or b"") * 5


# What each says, as pauses and bytes; whether it speaks as a client does; whether it reads what it is told.
KINDS = {
    "silent": (lambda listener, draw: iter(()), False, True),
    "half": (lambda listener, draw: iter([(0.0, draw.choice(listener.halves))]), False, True),
    "garbage": (lambda listener, draw: iter([(0.0, listener.stray(draw.randbytes(draw.randrange(1, 2000))))]), False, True),
    "drip": (drip, False, True),
    "reset": (None, False, True),
    "speaks": (lambda listener, draw: iter([(0.0, listener.hello)]), True, True),
    "hasty": (hasty, True, True),
    "deaf": (lambda listener, draw: hasty(listener, draw, 0.05), True, False),
    "endless": (lambda listener, draw: iter([(0.0, draw.choice(listener.endless))]), False, True),
    "late": (lambda listener, draw: iter([(0.0, listener.hello), (0.1, draw.choice(listener.endless_after_hello))]), True, True),
    "tls": (lambda listener, draw: iter([(0.0, listener.stray(TLS))]), False, True),
    "http": (lambda listener, draw: iter([(0.0, listener.stray(HTTP))]), False, True),
}
QUIET = [kind for kind, (_, speaks, _) in KINDS.items() if not speaks]


class Stranger:
    """One connection."""

    def __init__(self, sock, kind):
        self.sock, self.kind, self.speaks, self.reads = sock, kind, KINDS[kind][1], KINDS[kind][2]
        self.steps, self.out, self.received, self.is_connected = None, memoryview(b""), b"", False


class Storm:
    """All of them."""

    def __init__(self, listener, draw, count, seconds, kinds, limit):
        self.listener, self.draw, self.seconds, self.limit = listener, draw, seconds, limit
        self.kinds, self.quiet = kinds, [kind for kind in kinds if not KINDS[kind][1]] or QUIET
        self.poll, self.here = select.epoll(), {}
        self.due, self.number, self.speaking = [], 0, 0
        self.counts = collections.Counter()
        for when in self.moments(count):
            self.at(when, None)

    def moments(self, count):
        """Half of them come in a stream, half in bursts."""
        stream = [self.draw.uniform(0.0, self.seconds * 0.97) for _ in range(count - count // 2)]
        rest = count // 2
        while rest > 0:
            size, when = min(rest, self.draw.randrange(BURST // 10, BURST + 1)), self.draw.uniform(0.0, self.seconds * 0.95)
            stream += [when + self.draw.uniform(0.0, BURST_S) for _ in range(size)]
            rest -= size
        return stream

    def at(self, when, what):
        self.number += 1
        heapq.heappush(self.due, (when, self.number, what))

    def run(self):
        began = time.monotonic()
        while (now := time.monotonic() - began) < self.seconds:
            while self.due and self.due[0][0] <= now:
                when, _, what = heapq.heappop(self.due)
                if what is None:
                    self.counts["late_ms_max"] = max(self.counts["late_ms_max"], int((now - when) * 1000))
                    self.open(now)
                else:
                    what(now)
            pause = min(self.seconds, self.due[0][0] if self.due else self.seconds) - now
            for descriptor, events in self.poll.poll(min(max(pause, 0.0), 0.2), 256):
                if stranger := self.here.get(descriptor):
                    self.act(stranger, events, time.monotonic() - began)
        for stranger in list(self.here.values()):
            self.close(stranger)
        return dict(self.counts)

    def open(self, now):
        kind = self.draw.choice(self.kinds)
        source = self.draw.choice(ADDRESSES)
        if KINDS[kind][1] and self.limit is not None and self.speaking >= self.limit:
            kind = self.draw.choice(self.quiet)
        sock = socket.socket()
        sock.setblocking(False)
        # The port is chosen by both ends, so that there are enough.
        sock.setsockopt(socket.IPPROTO_IP, getattr(socket, "IP_BIND_ADDRESS_NO_PORT", 24), 1)
        sock.bind((source, 0))
        stranger = Stranger(sock, kind)
        self.counts["opened"] += 1
        if sock.connect_ex(self.listener.address) not in (0, errno.EINPROGRESS):
            self.counts["not_connected"] += 1
            return sock.close()
        self.here[sock.fileno()] = stranger
        self.speaking += stranger.speaks
        self.counts["held_max"] = max(self.counts["held_max"], len(self.here))
        self.poll.register(sock.fileno(), select.EPOLLOUT)

    def act(self, stranger, events, now):
        try:
            if not stranger.is_connected:
                if error := stranger.sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
                    raise OSError(error, os.strerror(error))
                self.connected(stranger, now)
                return
            if events & (select.EPOLLIN | select.EPOLLHUP | select.EPOLLERR):
                if not (came := stranger.sock.recv(PIECE)):
                    self.counts["sent_away"] += 1
                    return self.close(stranger)
                stranger.received = (stranger.received + came)[:4096]
            if events & select.EPOLLOUT:
                self.send(stranger)
        except BlockingIOError:
            pass
        except OSError:
            self.counts["sent_away" if stranger.is_connected else "not_connected"] += 1
            self.close(stranger)

    def connected(self, stranger, now):
        stranger.is_connected = True
        self.counts["connected"] += 1
        begin = KINDS[stranger.kind][0]
        if begin is None:
            return self.close(stranger, reset=True)
        stranger.steps = begin(self.listener, self.draw)
        self.watch(stranger)
        self.step(stranger, now)

    def step(self, stranger, now):
        """What it says next, or how long it still stays."""
        try:
            is_drawn = hasattr(stranger.steps, "send") and stranger.received
            pause_s, data = stranger.steps.send(stranger.received) if is_drawn else next(stranger.steps)
        except StopIteration:
            if self.draw.random() < 0.3:
                leaves, reset = now + self.draw.expovariate(0.2), self.draw.random() < 0.5
                self.at(leaves, lambda _: self.close(stranger, reset))
            return

        def say(then):
            if stranger.sock.fileno() < 0:
                return
            try:
                # One that is still busy with what it said before says no more.
                if not stranger.out:
                    stranger.out = memoryview(data)
                self.send(stranger)
            except BlockingIOError:
                pass
            except OSError:
                self.counts["sent_away"] += 1
                return self.close(stranger)
            self.step(stranger, then)

        self.at(now + pause_s, say)

    def send(self, stranger):
        if stranger.out:
            try:
                stranger.out = stranger.out[stranger.sock.send(stranger.out[:PIECE * 4]):]
            finally:
                self.watch(stranger)
        else:
            self.watch(stranger)

    def watch(self, stranger):
        wanted = (select.EPOLLIN if stranger.reads else 0) | (select.EPOLLOUT if stranger.out else 0)
        self.poll.modify(stranger.sock.fileno(), wanted)

    def close(self, stranger, reset=False):
        if stranger.sock.fileno() < 0:
            return
        del self.here[stranger.sock.fileno()]
        self.speaking -= stranger.speaks
        if reset:
            stranger.sock.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        stranger.sock.close()
