"""Both PLCs of the veneer peeling line at the byte level, written from the thesis (Nyyssönen 2018, ch. 2.1, 3.1 to 3.3).

Two TCP clients with bare frames: 360 bytes from the charger and 134 to it, 390 from the lathe and 130 to it. Each sends
every few milliseconds whether or not anything has changed, and reads what has come. They drive the whole line: blocks
from the step feeder over loader, centring spindles and transfer arms to the lathe, which peels them.

A PLC of the thesis holds Execute for 500 ms; here that is time of the simulation, which the charger receives.
"""

import argparse
import math
import socket
import struct
import sys
import threading
import time

EXECUTE_S = 0.5
GAP_S = 0.03  # Execute stays FALSE for so long, so that the next edge is seen.
EXECUTE, TRACKING, TORQUE, SPEED, ENABLE = (1 << bit for bit in range(5))
CLOSE, OPEN = TRACKING, TORQUE  # What these bits are for an axis that closes and opens.
ENABLED, IN_POSITION = 1, 2
FAR = 1e9

THICKNESS_MM, PEELING_M_S, CORE_MM = 3.0, 4.0, 31.0
SENSOR_MM = 500.0  # of the pre-centring above the apex of the loader's prism
APEX = 1 + math.sqrt(2)  # top of a cylinder of radius 1 above the apex of a prism of 90 degrees


class Axis:
    """A command frame of 30 bytes, and the 10 bytes that come back."""

    def __init__(self, window=0.0):
        self.window = window
        self.sent, self.waiting = (0, 0.0, 0.0, 0.0, 0.0), None
        self.execute, self.changed = False, -1.0
        self.flags, self.position, self.speed = 0, 0.0, 0.0

    def command(self, bits, position=0.0, speed=0.0, acceleration=0.0, torque=0.0):
        self.waiting = (bits, position, speed, acceleration, torque)

    def move(self, position, speed, acceleration):
        self.command(0, position, speed, acceleration)

    def frame(self, now):
        if self.execute and now - self.changed >= EXECUTE_S:
            self.execute, self.changed = False, now
        elif self.waiting and not self.execute and now - self.changed >= GAP_S:
            self.sent, self.waiting = self.waiting, None
            self.execute, self.changed = True, now
        bits, position, speed, acceleration, torque = self.sent
        bits |= ENABLE | (EXECUTE if self.execute else 0)
        return struct.pack(">BB7f", bits, 0, position, speed, acceleration, acceleration, torque, 0.0, 0.0)

    def take(self, data):
        self.flags, reserve, self.position, self.speed = struct.unpack(">BBff", data)
        assert self.flags < 4 and reserve == 0, f"reserve is not 0: {data.hex()}"

    @property
    def is_there(self):
        """What was commanded last is reached."""
        bits, position = self.sent[:2]
        near = abs(self.position - position) <= self.window
        return not self.waiting and not bits and bool(self.flags & IN_POSITION) and near

    @property
    def is_open(self):
        return not self.waiting and bool(self.sent[0] & OPEN) and self.position >= 20000

    @property
    def grips(self):
        closed = not self.waiting and bool(self.sent[0] & CLOSE) and bool(self.flags & IN_POSITION)
        return closed and 8000 <= self.position <= 12000


def close(*axes, torque=100.0):
    for axis in axes:
        axis.command(CLOSE, torque=torque)


def open_(*axes):
    for axis in axes:
        axis.command(OPEN, torque=100.0)


class Coupling:
    """What the two PLCs say to each other."""

    def __init__(self):
        self.now = 0.0
        self.block_at_lathe = self.block_held = self.lathe_ready = False
        self.arms_clear = False
        self.radius_mm = 0.0


class Charger:
    NAMES = (
        "feeder loader left_x left_y right_x right_y spindle_left spindle_right rotation arms clamp_left clamp_right"
    ).split()
    WINDOWS = {"feeder": 100, "loader": 8, "arms": 40}
    TAIL = struct.Struct(">BB3f")

    def __init__(self, coupling):
        self.coupling = coupling
        self.axes = {name: Axis(self.WINDOWS.get(name, 20)) for name in self.NAMES}
        self.__dict__.update(self.axes)
        self.size = 10 * len(self.axes) + self.TAIL.size
        self.steps, self.left_mm, self.right_mm = 0, 0.0, 0.0
        self.is_loader_there = self.is_measured = self.is_loader_between = False
        self.has_loader_block = self.spindles_hold = self.clamps_hold = self.is_ready_for_loader = False
        self.is_at_height, self.loader_mm, self.spindle_mm = False, 0.0, 0.0
        self.sequences = [self.feed(), self.load(), self.centre(), self.transfer()]

    def tail(self, data):
        self.steps, reserve, self.left_mm, self.right_mm, now = self.TAIL.unpack(data)
        assert self.steps < 16 and reserve == 0, f"reserve is not 0: {data.hex()}"
        self.coupling.now = now

    def scan(self):
        for sequence in self.sequences:
            next(sequence)
        self.coupling.arms_clear = self.arms.position >= 8000

    def feed(self):
        """Blocks climb from step to step; a stroke with one in the last step brings it onto the loader."""
        while True:
            self.feeder.move(0.0, 120000.0, 400000.0)
            yield
            while not self.feeder.is_there:
                yield
            while not (self.is_loader_there if self.steps & 8 else self.steps):
                yield
            delivers = bool(self.steps & 8)
            if delivers:
                self.is_loader_there = False
            self.feeder.move(65000.0, 120000.0, 400000.0)
            yield
            while not self.feeder.is_there:
                yield
            self.has_loader_block |= delivers

    def load(self):
        while True:
            self.loader.move(13950.0, 16000.0, 40000.0)
            yield
            while not self.loader.is_there:
                yield
            self.is_loader_there = True
            while not self.has_loader_block:
                yield
            self.loader.move(6300.0, 16000.0, 40000.0)
            yield
            while not self.loader.is_there:
                yield
            sums = 0.0
            for _ in range(4):
                sums += 0.5 * (self.left_mm + self.right_mm)
                yield
            self.loader_mm = (SENSOR_MM - sums / 4) / APEX
            self.is_measured = True
            while not self.is_ready_for_loader:
                yield
            self.loader.move(0.0, 16000.0, 40000.0)
            yield
            while not self.loader.is_there:
                yield
            self.is_loader_between = True
            while not self.spindles_hold:
                yield
            self.is_measured = self.is_loader_between = self.has_loader_block = False

    def centre(self):
        spindles, ends = (self.spindle_left, self.spindle_right), (self.left_y, self.right_y)
        for x in (self.left_x, self.right_x):
            x.move(32500.0, 50000.0, 200000.0)
        open_(*spindles)
        while True:
            yield
            while not (self.is_measured and all(one.is_open for one in spindles)):
                yield
            for y in ends:
                y.move(100 * math.sqrt(2) * self.loader_mm, 60000.0, 300000.0)
            yield
            while not all(axis.is_there for axis in (*ends, self.left_x, self.right_x)):
                yield
            self.is_ready_for_loader = True
            while not self.is_loader_between:
                yield
            self.is_ready_for_loader = False
            close(*spindles)
            yield
            while not all(one.grips for one in spindles):
                yield
            close(*spindles, torque=60.0)
            self.spindles_hold, self.spindle_mm = True, self.loader_mm
            for y in ends:
                y.move(40000.0, 60000.0, 300000.0)
            self.rotation.move(3600.0 if self.rotation.position < 1800 else 0.0, 7200.0, 36000.0)
            yield
            while not all(axis.is_there for axis in (*ends, self.rotation)):
                yield
            self.is_at_height = True
            while not self.clamps_hold:
                yield
            self.is_at_height = False
            open_(*spindles)
            yield
            while not all(one.is_open for one in spindles):
                yield
            self.spindles_hold = False

    def transfer(self):
        clamps, coupling = (self.clamp_left, self.clamp_right), self.coupling
        open_(*clamps)
        while True:
            self.arms.move(37500.0, 80000.0, 250000.0)
            yield
            while not (self.arms.is_there and self.is_at_height and all(one.is_open for one in clamps)):
                yield
            close(*clamps)
            yield
            while not all(one.grips for one in clamps):
                yield
            close(*clamps, torque=60.0)
            self.clamps_hold = True
            coupling.radius_mm = self.spindle_mm
            while self.spindles_hold:
                yield
            if not coupling.lathe_ready:
                self.arms.move(20000.0, 80000.0, 250000.0)
                yield
                while not coupling.lathe_ready:
                    yield
            self.arms.move(0.0, 80000.0, 250000.0)
            yield
            while not self.arms.is_there:
                yield
            coupling.block_at_lathe = True
            while not coupling.block_held:
                yield
            open_(*clamps)
            yield
            while not all(one.is_open for one in clamps):
                yield
            coupling.block_at_lathe = self.clamps_hold = False


class Lathe:
    NAMES = (
        "left_outer left_inner right_outer right_inner rotation knife nosebar pitch roll_top roll_bottom roll_arm "
        "roll_rotation conveyor"
    ).split()
    WINDOWS = {"nosebar": 10, "roll_top": 50, "roll_bottom": 50, "roll_arm": 200}

    def __init__(self, coupling):
        self.coupling = coupling
        self.axes = {name: Axis(self.WINDOWS.get(name, 20)) for name in self.NAMES}
        self.__dict__.update(self.axes)
        self.size = 10 * len(self.axes)
        self.outer, self.inner = (self.left_outer, self.right_outer), (self.left_inner, self.right_inner)
        self.peeled = 0
        self.sequences = [self.peel()]

    def tail(self, data):
        assert not data

    def scan(self):
        for sequence in self.sequences:
            next(sequence)

    def turn(self):
        """Veneer leaves at a constant speed: the spindles follow the radius, in every scan (ch. 3.1.4)."""
        turns_s = PEELING_M_S / (2 * math.pi * 1e-5 * max(self.knife.position, 2500.0))
        bits, position, _, acceleration, torque = self.rotation.sent
        self.rotation.sent = (bits, position, 100 * turns_s, acceleration, torque)

    def retreat(self):
        for axis in (self.knife, self.roll_top, self.roll_bottom):
            axis.move(30000.0, 60000.0, 200000.0)
        self.roll_arm.move(65000.0, 200000.0, 900000.0)

    def approach(self):
        waiting = 100 * (self.coupling.radius_mm + 3)
        self.knife.move(waiting, 60000.0, 200000.0)
        for roll in (self.roll_top, self.roll_bottom):
            roll.move(100 * (self.coupling.radius_mm + 5), 60000.0, 200000.0)
        self.roll_arm.move(0.0, 200000.0, 900000.0)
        self.nosebar.move(87 * THICKNESS_MM, 2000.0, 20000.0)
        self.pitch.command(TRACKING, 0.0, 1000.0, 10000.0)
        self.roll_rotation.command(TRACKING, 0.0, 80000.0, 600000.0)
        self.rotation.command(SPEED, FAR, 0.0, 6000.0)

    def track(self):
        self.knife.command(TRACKING, 0.0, 20000.0, 200000.0, torque=100 * THICKNESS_MM)
        self.roll_top.command(TRACKING, 25 * THICKNESS_MM, 20000.0, 200000.0)
        self.roll_bottom.command(TRACKING, 50 * THICKNESS_MM, 20000.0, 200000.0)

    def stand(self):
        bits, *rest = self.rotation.sent
        self.rotation.sent = (bits & ~SPEED, *rest)

    def peel(self):
        coupling, spindles = self.coupling, (*self.outer, *self.inner)
        away = (self.knife, self.roll_top, self.roll_bottom, self.roll_arm)
        placed = (*away, self.nosebar)
        self.retreat()
        open_(*spindles)
        while True:
            yield
            while not (all(axis.is_there for axis in away) and all(one.is_open for one in spindles)):
                yield
            coupling.lathe_ready = True
            while not coupling.block_at_lathe:
                yield
            coupling.lathe_ready = False
            close(*spindles)
            yield
            while not all(one.grips for one in spindles):
                yield
            close(*spindles, torque=60.0)
            coupling.block_held = True
            while coupling.block_at_lathe or not coupling.arms_clear:
                yield
            coupling.block_held = False
            self.approach()
            yield
            while not (all(axis.is_there for axis in placed) and self.rotation.speed >= 0.97 * self.rotation.sent[2] > 0):
                self.turn()
                yield
            self.track()
            is_outer_open = False
            while self.knife.position + 0.045 * self.knife.speed > 100 * CORE_MM:
                self.turn()
                if self.knife.position <= 7500 and not is_outer_open:
                    is_outer_open = True
                    open_(*self.outer)
                yield
            self.retreat()
            while self.knife.position < 20000:
                yield
            self.stand()
            while self.rotation.speed > 1.0 or not all(axis.is_there for axis in away):
                yield
            open_(*self.inner)
            self.conveyor.command(SPEED, FAR, 5000.0, 10000.0)
            yield
            while not all(one.is_open for one in spindles):
                yield
            self.peeled += 1
            print(f"lathe: {self.peeled} peeled at {coupling.now:.1f} s", flush=True)


class Link:
    """A PLC's connection: frames are cut from the stream by length alone."""

    def __init__(self, name, plc, port, push_s):
        self.name, self.plc, self.push_s = name, plc, push_s
        self.link, self.data, self.fault = connected(port), b"", None

    def receive(self):
        size = self.plc.size
        while len(self.data) >= size:
            frame, self.data = self.data[:size], self.data[size:]
            for index, axis in enumerate(self.plc.axes.values()):
                axis.take(frame[10 * index : 10 * index + 10])
            self.plc.tail(frame[10 * len(self.plc.axes) :])

    def run(self):
        """Scans at an interval, as a PLC does: receives what is there, runs the program, sends."""
        self.link.setblocking(False)
        due = time.monotonic()
        try:
            while True:
                try:
                    while part := self.link.recv(65536):
                        self.data += part
                    break  # The session is over.
                except BlockingIOError:
                    self.receive()
                self.plc.scan()
                now = self.plc.coupling.now
                self.link.sendall(b"".join(axis.frame(now) for axis in self.plc.axes.values()))
                due += self.push_s
                time.sleep(max(0.0, due - time.monotonic()))
        except ConnectionError:
            pass  # The session is over.
        except AssertionError as fault:
            self.fault = f"{self.name}: {fault}"
        self.link.close()


def connected(port):
    for _ in range(3000):
        try:
            link = socket.create_connection(("127.0.0.1", port))
        except ConnectionRefusedError:
            time.sleep(0.02)
        else:
            link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return link
    sys.exit(f"nobody listens on port {port}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ports", type=int, nargs=2, metavar=("CHARGER", "LATHE"), default=(2000, 2001))
    parser.add_argument("--push", type=float, metavar="MS", default=10.0, help="interval of the PLCs' cycles")
    arguments = parser.parse_args()
    coupling = Coupling()
    plcs = {"charger": Charger(coupling), "lathe": Lathe(coupling)}
    links = [Link(*plc, port, arguments.push / 1000) for plc, port in zip(plcs.items(), arguments.ports)]
    threads = [threading.Thread(target=link.run) for link in links]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    sys.exit("\n".join(link.fault for link in links if link.fault) or 0)


main()
