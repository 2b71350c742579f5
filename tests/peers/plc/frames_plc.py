"""Two PLCs of a peeling line at the byte level, written from the thesis (Nyyssönen 2018, ch. 3.1, Figs. 13, 17, 18, 22).

Each is a TCP client, sends its frame every 10 ms whether or not anything has changed, and moves one axis: Execute is held
for 500 ms, then it waits until the axis is in position. `--print N` writes N frames of each kind, with the values that are
in them, for another codec to be compared with.
"""

import argparse
import random
import socket
import struct
import sys
import threading
import time

PUSH_S = 0.010
EXECUTE_PUSHES = 50  # 500 ms
EXECUTE, TRACKING, TORQUE, SPEED, ENABLE = (1 << bit for bit in range(5))
ENABLED, IN_POSITION = 1, 2


def command(flags, position=0.0, speed=0.0, acceleration=0.0, deceleration=0.0, torque=0.0):
    """The 30 bytes of an axis: 16 bits, five REALs, two REALs of reserve; big-endian."""
    return struct.pack(">BB7f", flags, 0, position, speed, acceleration, deceleration, torque, 0.0, 0.0)


def feedback(data):
    """Flags, position and speed out of the ten bytes of an axis."""
    flags, reserve, position, speed = struct.unpack(">BBff", data)
    assert flags < 4 and reserve == 0, f"reserve is not 0: {data.hex()}"
    return flags, position, speed


class Machine:
    """A PLC with so many axes, one of which it moves."""

    def __init__(self, name, axes, tail, axis, target):
        self.name, self.axes, self.axis, self.target = name, axes, axis, target
        self.size = 10 * axes + tail
        self.flags, self.position = 0, 0.0
        self.pushes, self.is_there, self.is_over, self.fault = 0, False, False, None

    def frame(self):
        """What goes out now; the pushes of Execute are counted."""
        flags = ENABLE
        if self.flags & ENABLED and self.pushes < EXECUTE_PUSHES:
            self.pushes += 1
            flags |= EXECUTE
        one = command(flags, self.target, 8000.0, 15000.0, 15000.0)
        return b"".join(one if axis == self.axis else command(ENABLE) for axis in range(1, self.axes + 1))

    def take(self, frame):
        for axis in range(self.axes):
            flags, position, speed = feedback(frame[10 * axis : 10 * axis + 10])
            if axis + 1 != self.axis:
                assert (position, speed) == (0.0, 0.0), f"axis {axis + 1} moves"
                continue
            if self.pushes == EXECUTE_PUSHES and flags & IN_POSITION and not self.is_there:
                assert position == self.target, position
                self.is_there = True
                print(f"{self.name}: axis {self.axis} in position at {position}", flush=True)

            self.flags, self.position = flags, position

    def receive(self, link):
        data = b""
        try:
            while part := link.recv(65536):
                data += part
                while len(data) >= self.size:
                    self.take(data[: self.size])
                    data = data[self.size :]
            assert not data, f"{len(data)} of {self.size} bytes"
        except (AssertionError, OSError) as fault:
            self.fault = None if isinstance(fault, ConnectionError) else f"{self.name}: {fault}"
        self.is_over = True

    def run(self, port):
        link = connected(port)
        receiver = threading.Thread(target=self.receive, args=(link,))
        receiver.start()
        due = time.monotonic()
        try:
            while not self.is_over:
                link.sendall(self.frame())
                due += PUSH_S
                time.sleep(max(0.0, due - time.monotonic()))
        except ConnectionError:
            pass  # The session is over.
        receiver.join()
        link.close()


def connected(port):
    for _ in range(1000):
        try:
            link = socket.create_connection(("127.0.0.1", port))
        except ConnectionRefusedError:
            time.sleep(0.02)
        else:
            link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return link
    sys.exit(f"nobody listens on port {port}")


def printed(count):
    """Frames and their values, little-endian and unpadded, as hexadecimal."""
    draw = random.Random(1)
    real = lambda: struct.unpack("<f", struct.pack("<f", draw.choice([0.0, 1.0, draw.uniform(-7e4, 7e4), draw.gauss(0, 1e-3)])))[0]
    for _ in range(count):
        flags, reals = draw.randrange(32), [real() for _ in range(5)]
        bits = bytes(flags >> bit & 1 for bit in range(5))
        print("command", command(flags, *reals).hex(), (bits + struct.pack("<5f", *reals)).hex())
        flags, reals = draw.randrange(4), [real() for _ in range(2)]
        print("feedback", struct.pack(">BBff", flags, 0, *reals).hex(), (bytes([flags & 1, flags >> 1]) + struct.pack("<2f", *reals)).hex())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--ports", type=int, nargs=2, metavar=("CHARGER", "LATHE"))
    parser.add_argument("--print", type=int, metavar="N")
    arguments = parser.parse_args()
    if arguments.print:
        return printed(arguments.print)
    machines = [Machine("charger", 12, 14, 2, 6300.0), Machine("lathe", 13, 0, 6, 2000.0)]
    threads = [threading.Thread(target=m.run, args=(port,)) for m, port in zip(machines, arguments.ports)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    faults = [m.fault or f"{m.name}: axis {m.axis} is at {m.position}" for m in machines if m.fault or not m.is_there]
    sys.exit("\n".join(faults) or 0)


main()
