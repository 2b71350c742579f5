"""A line scanner of a rotary kiln in a process of its own, written from the table of its protocol and the equations on the pages of
its component and of the kiln's heat. `--link tcp` for Ethernet.

| it hears | it says |
|---|---|
| SOH, command, EOT, check byte | ACK, or NAK if it is not a command; the check byte is the sum of all before it, its highest bit set |
| STX | SYN, a byte for each point, its internal temperature |
"""
from __future__ import annotations

import argparse
import math
import sys
from typing import Any, Dict, List, Optional, Union

from onescan_client import Input, ListeningPort, Output, SerialPort, Simulation

SOH, STX, EOT, ACK, NAK, SYN = 0x01, 0x02, 0x04, 0x06, 0x15, 0x16
WINDOW = 512
ZONES, LENGTH_M, RADIUS_M, AMBIENT_DEGC, ZERO_K, SIGMA = 24, 60.0, 2.0, 20.0, 273.15, 5.670374419e-8


def check_byte(message: bytes) -> int:
    """The check byte behind these bytes."""
    return sum(message) % 256 | 0x80


def zone_degc(x_m: float) -> float:
    """The steady temperature of the shell at the middle of a zone: as much heat comes in as goes out."""
    gas_degc = 600.0 + (1450.0 - 600.0) * math.exp(-0.5 * ((x_m - 15.0) / 18.0) ** 2)
    coating_m = 0.1 + 0.15 * math.exp(-0.5 * ((x_m - 40.0) / 1.5) ** 2)
    layers = 1.0 / 150.0 + coating_m / 1.5 + 0.2 / 3.0

    def gain(degc: float) -> float:
        radiation = 0.85 * SIGMA * ((degc + ZERO_K) ** 4 - (AMBIENT_DEGC + ZERO_K) ** 4)
        return (gas_degc - degc) / layers - 15.0 * (degc - AMBIENT_DEGC) - radiation

    low, high = AMBIENT_DEGC, gas_degc
    for _ in range(200):
        middle = (low + high) / 2.0
        low, high = (middle, high) if gain(middle) > 0.0 else (low, middle)
    return low


ZONE_DEGC = [zone_degc((zone + 0.5) / ZONES * LENGTH_M) for zone in range(ZONES)]


def surface_degc(x_m: float, angle_rad: float) -> float:
    """The temperature of the shell: straight from zone to zone, and a spot of 60 K at 22 m and 130 degrees."""
    place = min(max(x_m / LENGTH_M * ZONES - 0.5, 0.0), ZONES - 1.0)
    left = min(int(place), ZONES - 2)
    part = place - left
    between = math.remainder(angle_rad - math.radians(130.0), 2.0 * math.pi)
    exponent = 0.5 * (((x_m - 22.0) / 0.8) ** 2 + (RADIUS_M * between / 0.8) ** 2)
    return ZONE_DEGC[left] * (1.0 - part) + ZONE_DEGC[left + 1] * part + 60.0 * math.exp(-exponent)


class Scanner(Simulation):
    """An infrared line scanner."""

    link = "serial"

    Angle: Input[float] = Input("LREAL")
    To_scanner: Input[str] = Input(f"BYTES[{WINDOW}]")
    From_scanner: Output[str] = Output(f"BYTES[{WINDOW}]")
    Scanner_lines: Output[int] = Output("DINT")
    Accepted: Output[int] = Output("DINT")
    Refused: Output[int] = Output("DINT")

    def start(self) -> None:
        self.port: Dict[str, Any] = {}
        self.heard: List[int] = []
        self.settings = {"points": 256, "lower": 0, "upper": 500}

    def step(self) -> None:
        port: Union[ListeningPort, SerialPort]
        port = ListeningPort(self.port, WINDOW) if self.link == "tcp" else SerialPort(self.port, WINDOW)
        port.arrive(self.t_ns, self.To_scanner)
        for byte in port.take(len(port.received)):
            answer = self.hear(byte)
            if answer is not None and (self.link != "tcp" or port.is_open):
                port.send(answer)
        self.From_scanner = port.depart(self.t_ns, self.To_scanner)

    def hear(self, byte: int) -> Optional[bytes]:
        """What it says to a byte."""
        if not self.heard:
            if byte == STX:
                self.Scanner_lines += 1
                return self.line()
            if byte == SOH:
                self.heard = [byte]
            return None
        self.heard.append(byte)
        if self.heard[-2] != EOT:
            return None
        message, self.heard = bytes(self.heard), []
        if message[-1] == check_byte(message[:-1]) and self.obey(message[1:-2].decode("ascii")):
            self.Accepted += 1
            return bytes([ACK])
        self.Refused += 1
        return bytes([NAK])

    def obey(self, command: str) -> bool:
        """Takes a command; whether it is one."""
        opcode, value = command[:2], command[2:]
        if opcode == "PM" and value in ("1", "2", "3", "4", "5"):
            self.settings["points"] = 32 << int(value)
        elif opcode in ("SB", "ST") and value.isdigit() and value[0] == "0":
            self.settings["lower" if opcode == "SB" else "upper"] = int(value[1:])
        else:
            # what is left of the file needs no work: the emissivity is that of the shell
            return command in ("AR", "DMB", "RMH", "ES095")
        return True

    def line(self) -> bytes:
        """What it sees."""
        points, lower, upper = self.settings["points"], self.settings["lower"], self.settings["upper"]
        seen = [SYN]
        for index in range(points):
            x_m = 30.0 + 30.0 * math.tan(math.radians(90.0 * ((index + 0.5) / points - 0.5)))
            value = 255.0 * (surface_degc(x_m, self.Angle) - lower) / (upper - lower)
            seen.append(min(max(math.floor(value + 0.5), 0), 255))
        return bytes(seen + [int(AMBIENT_DEGC + 6.0)])


if __name__ == "__main__":
    own = argparse.ArgumentParser(add_help=False)
    own.add_argument("--link", choices=("serial", "tcp"), default="serial")
    chosen, rest = own.parse_known_args(sys.argv[1:])
    Scanner.link = chosen.link
    Scanner("scanner").main(rest)
