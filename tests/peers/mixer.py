#!/usr/bin/env python3
"""A participant in plain Python that mixes all it sees into one number, and can misbehave on purpose.

    mixer.py --server 127.0.0.1:4840 --name alpha

It exits with 0 when the session was completed or stopped, 2 when it was refused, 3 when it failed or the
server was lost.
"""
from __future__ import annotations

import argparse
import json
import sys

from onescan_client import (Fields, LockstepClient, LostServer, Participant, ProtocolError, Refused,
                            SessionEnded, SessionFailed)


class Mixer(Participant):
    """Mixes the time and all inputs, in their order, into 64 bits of state, which are its one output."""

    def __init__(self, name: str) -> None:
        self.name, self.state = name, 1

    def _mix(self, value: int) -> None:
        x = (self.state ^ value) * 0x9E3779B97F4A7C15 % 2**64
        self.state = (x << 29 | x >> 35) % 2**64

    def setup(self) -> Fields:
        self.state = 1
        for byte in self.name.encode("utf-8"):
            self._mix(byte)
        return {f"{self.name}.out": self.state}

    def turn(self, t_v_ns: int, inputs: Fields) -> Fields:
        for value in (t_v_ns, *inputs.values()):
            self._mix(value)
        return {f"{self.name}.out": self.state}

    def save(self) -> bytes:
        return self.state.to_bytes(8, "little")

    def restore(self, state: bytes) -> None:
        if len(state) != 8:
            raise ValueError(f"a state of {len(state)} bytes in place of 8")
        self.state = int.from_bytes(state, "little")


class Misbehaving(LockstepClient):
    """A client that does something wrong on the first grant with `t_v` at or after a given time: it vanishes,
    sends `fault`, answers another step, sends one output byte too few, never answers, or sends no frame."""

    KINDS = ("fail", "fault", "wrong-sequence", "short", "hang", "garbage")

    def __init__(self, host: str, port: int, faults: dict[str, int]) -> None:
        super().__init__(host, port)
        self._faults = faults  # kind -> time

    def _send_turn(self, sequence: int, t_v_ns: int, wake_ns: int, outputs: bytes) -> None:
        due = [kind for kind, time_ns in self._faults.items() if sequence > 0 and t_v_ns >= time_ns]
        kind = due[0] if due else None
        if kind is not None:
            del self._faults[kind]
        if kind == "fail":
            raise LostServer("vanished, as asked for")
        if kind == "fault":
            self._send_fault(RuntimeError("asked for"))
            raise LostServer("left after a fault, as asked for")
        if kind == "garbage":
            return self._send_raw(b"\xff" * 32)
        while kind == "hang":  # until the server closes
            self._read(1)
        super()._send_turn(sequence + (kind == "wrong-sequence"), t_v_ns, wake_ns,
                           outputs[:-1] if kind == "short" else outputs)


def main() -> int:
    parser = argparse.ArgumentParser(description="A Mixer that takes part in a lockstep session.")
    parser.add_argument("--server", required=True, metavar="HOST:PORT")
    parser.add_argument("--name", required=True, help="the client's name; it writes NAME.out")
    parser.add_argument("--reads", metavar="A,B", help="clients whose .out is read, in order; default: all")
    parser.add_argument("--period-ns", type=int, metavar="NS", help="default: the session's step")
    for kind in Misbehaving.KINDS:
        parser.add_argument(f"--{kind}-at", type=int, metavar="NS", dest=kind, help="misbehave, for tests")
    options = parser.parse_args()
    host, _, port = options.server.rpartition(":")
    faults = {kind: at for kind in Misbehaving.KINDS if (at := vars(options)[kind]) is not None}
    try:
        with Misbehaving(host.strip("[]"), int(port), faults) as client:
            welcome = client.connect("mixer.py")
            others = sorted(s["name"].removesuffix(".out") for s in welcome["signals"] if s["type"] == "ULINT"
                            and s["name"].endswith(".out") and s["name"] != f"{options.name}.out")
            if options.reads is not None:
                others = [name for name in options.reads.split(",") if name]
            client.join(options.name, options.period_ns or welcome["step_ns"],
                        [(f"{name}.out", "ULINT") for name in others], [(f"{options.name}.out", "ULINT")])
            print(json.dumps(client.run(Mixer(options.name))))
    except Refused as error:
        print(f"refused: {error}", file=sys.stderr)
        return 2
    except (SessionFailed, ProtocolError, LostServer) as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 3
    except SessionEnded as ended:
        print(json.dumps(ended.end))
    return 0


if __name__ == "__main__":
    sys.exit(main())
