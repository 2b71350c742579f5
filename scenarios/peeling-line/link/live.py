"""Both PLCs at the other end of the live link, which watch what comes as Wireshark did for the thesis (Nyyssönen 2018, 4.1, Table 4).

Each is a TCP client: it pushes its frame (360 bytes from the charger, 390 from the lathe, nothing but Enable in it) every 10 ms by
this machine's clock, and notes when each frame of the simulation (134 and 130 bytes) has come. When the session is over, this
prints the intervals, and how old what a PLC knows is: since the last frame came, and the millisecond that the thesis has on the wire.
"""

import argparse
import json
import select
import socket
import statistics
import struct
import sys
import threading
import time

PUSH_S = 0.010
WIRE_MS = 1.0  # what the thesis assumes; over the loopback it is less
ENABLE = 16


class Plc:
    """A PLC by its axes and the bytes that come after them."""

    def __init__(self, name, axes, tail):
        self.name, self.size = name, 10 * axes + tail
        self.frame = struct.pack(">BB7f", ENABLE, 0, *[0.0] * 7) * axes
        self.came_s = []

    def run(self, port):
        link = connected(port)
        held, due = 0, time.monotonic()
        try:
            while True:
                if select.select([link], [], [], max(0.0, due - time.monotonic()))[0]:
                    part = link.recv(65536)
                    if not part:
                        break  # The session is over.
                    held += len(part)
                    whole, held = divmod(held, self.size)
                    self.came_s += whole * [time.monotonic()]
                if time.monotonic() >= due:
                    link.sendall(self.frame)
                    due += PUSH_S
        except ConnectionError:
            pass  # The session is over.
        link.close()

    def found(self):
        """Intervals and ages in ms."""
        gaps = [1000 * (after - before) for before, after in zip(self.came_s, self.came_s[1:])]
        if len(gaps) < 2:
            sys.exit(f"{self.name}: {len(self.came_s)} frames came")
        # One looks at any time, so more often in a long gap than in a short one.
        mean_ms = sum(gap * gap for gap in gaps) / (2 * sum(gaps)) + WIRE_MS
        return {
            "frames": len(self.came_s),
            "mean_ms": statistics.fmean(gaps),
            "sigma_ms": statistics.stdev(gaps),
            "least_ms": min(gaps),
            "greatest_ms": max(gaps),
            "age_ms": mean_ms,
            "oldest_ms": max(gaps) + WIRE_MS,
        }


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
    parser.add_argument("--record", metavar="FILE", help="write when each frame came, in s, as JSON")
    arguments = parser.parse_args()
    plcs = [Plc("charger", 12, 14), Plc("lathe", 13, 0)]
    threads = [threading.Thread(target=plc.run, args=(port,)) for plc, port in zip(plcs, arguments.ports)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if arguments.record:
        with open(arguments.record, "w", encoding="utf-8") as file:
            json.dump({plc.name: plc.came_s for plc in plcs}, file)
    print("to       frames  mean ms    σ ms  least ms  greatest ms  age ms  oldest ms")
    founds = {plc.name: plc.found() for plc in plcs}
    for name, found in founds.items():
        print("{:8}".format(name), "{frames:6} {mean_ms:8.2f} {sigma_ms:7.2f} {least_ms:9.2f} {greatest_ms:12.2f}".format(**found),
              "{age_ms:7.2f} {oldest_ms:10.2f}".format(**found))
    age_ms = statistics.fmean(found["age_ms"] for found in founds.values())
    oldest_ms = max(found["oldest_ms"] for found in founds.values())
    print(f"the status is {age_ms:.2f} ms old on average, {oldest_ms:.2f} ms at most")


main()
