"""Ports at which a simulation sends and receives bytes (PROTOCOL.md, section 3.2, `BYTES[n]`).

A port stands on a dict, which is part of the simulation's state: `self.port = {}` in `start`, and in `step`

    port = SerialPort(self.port, 64, baud=9600)
    port.arrive(self.t_ns, self.Command)
    if port.received.startswith(b"\\x02"): port.take(1); port.send(answer)
    self.Answer = port.depart(self.t_ns, self.Command)
"""
from __future__ import annotations

import struct
from typing import Any, Dict, List, Optional

_HEADER = struct.Struct("<QQQI")


class Line:
    """One direction of a line, as the value of a signal: a text in hexadecimal."""

    def __init__(self, value: str, window: int) -> None:
        data = bytes.fromhex(value)
        if len(data) != size(window):
            raise ValueError(f"{len(data)} bytes are no line with a window of {window}")
        self.count, self.since, self.acknowledged, self.link = _HEADER.unpack_from(data)
        self.window = window
        self._ring = bytearray(data[_HEADER.size:_HEADER.size + window])
        self._lost = bytearray(data[_HEADER.size + window:])

    def at(self, number: int) -> Optional[int]:
        """The byte of this number; None if it was lost on its way."""
        place = number % self.window
        return None if self._lost[place // 8] >> place % 8 & 1 else self._ring[place]

    def put(self, byte: int) -> None:
        """Puts a byte on the line."""
        place = self.count % self.window
        self._ring[place] = byte
        self._lost[place // 8] &= ~(1 << place % 8) & 0xff
        self.count += 1

    def value(self) -> str:
        """The value of the signal."""
        return (_HEADER.pack(self.count, self.since, self.acknowledged, self.link) + self._ring + self._lost).hex()


def size(window: int) -> int:
    """Bytes of a line with a window of so many."""
    return _HEADER.size + window + (window + 7) // 8


class _Port:
    """What both forms of a port have; see `SerialPort` and `ListeningPort`."""

    def __init__(self, state: Dict[str, Any], window: int) -> None:
        start: Dict[str, Any] = {"line": "00" * size(window), "read": 0, "received": [], "queue": [], "lost": 0}
        for key, value in start.items():
            state.setdefault(key, value)
        self._state, self._window = state, window

    @property
    def received(self) -> bytes:
        """Bytes that have arrived and were not taken."""
        return bytes(self._state["received"])

    @property
    def lost(self) -> int:
        """Bytes that did not get through."""
        lost: int = self._state["lost"]
        return lost

    def take(self, most: int) -> bytes:
        """The next bytes that have arrived, at most so many."""
        taken = bytes(self._state["received"][:most])
        del self._state["received"][:most]
        return taken

    def send(self, data: bytes) -> None:
        """Sends bytes behind those that wait."""
        self._state["queue"].extend(data)

    def _read(self, line: Line) -> None:
        read = min(self._state["read"], line.count)
        oldest = max(line.count - line.window, 0)
        self._state["lost"] += max(oldest - read, 0)
        for number in range(max(read, oldest), line.count):
            byte = line.at(number)
            if byte is None:
                self._state["lost"] += 1
            else:
                self._state["received"].append(byte)
        self._state["read"] = line.count

    def _put(self, count: int) -> None:
        line = Line(self._state["line"], self._window)
        queue: List[int] = self._state["queue"]
        for byte in queue[:count]:
            line.put(byte)
        del queue[:count]
        self._state["line"] = line.value()


class SerialPort(_Port):
    """A serial port: bytes one behind the other, 10 bits each for 8N1."""

    def __init__(self, state: Dict[str, Any], window: int, baud: int = 9600, bits_per_byte: int = 10) -> None:
        super().__init__(state, window)
        state.setdefault("busy", None)
        self._baud, self._bits = baud, bits_per_byte

    def arrive(self, t_ns: int, value: str) -> None:
        """First part of a step that ends at `t_ns`; `value` is the signal that the port reads."""
        busy: Optional[List[int]] = self._state["busy"]
        if busy is not None:
            over = (t_ns - busy[0]) * self._baud // 1_000_000_000 // self._bits
            done = min(over - busy[1], len(self._state["queue"]))
            busy[1] += done
            self._put(done)
            if not self._state["queue"]:
                self._state["busy"] = None
        self._read(Line(value, self._window))

    def depart(self, t_ns: int, value: str) -> str:
        """Last part of a step: the value of the signal that the port writes."""
        if self._state["queue"] and self._state["busy"] is None:
            self._state["busy"] = [t_ns, 0]
        line: str = self._state["line"]
        return line


class ListeningPort(_Port):
    """The side of a connection that waits for the other to connect, as a server of TCP does."""

    def __init__(self, state: Dict[str, Any], window: int) -> None:
        super().__init__(state, window)
        for key in ("number", "is_open", "is_closing"):
            state.setdefault(key, 0)

    @property
    def is_open(self) -> bool:
        """Whether there is a connection."""
        return bool(self._state["is_open"])

    def disconnect(self) -> None:
        """Ends the connection once all is sent."""
        self._state["is_closing"] = self._state["is_open"]

    def arrive(self, t_ns: int, value: str) -> None:
        """First part of a step that ends at `t_ns`; `value` is the signal that the port reads."""
        state, other = self._state, Line(value, self._window)
        if other.link % 2 == 1 and other.link > state["number"]:
            state.update(number=other.link, is_open=1, is_closing=0, read=other.since, received=[], queue=[])
        if state["is_open"] and other.link in (state["number"], state["number"] + 1):
            self._read(other)
            if other.link == state["number"] + 1:
                state.update(is_closing=1, queue=[])

    def depart(self, t_ns: int, value: str) -> str:
        """Last part of a step: the value of the signal that the port writes."""
        state, other = self._state, Line(value, self._window)
        line = Line(state["line"], self._window)
        line.acknowledged = state["read"]
        if state["is_open"] and line.link != state["number"]:
            line.link, line.since = state["number"], line.count
        state["line"] = line.value()
        if state["is_open"]:
            self._put(max(self._window - max(line.count - other.acknowledged, 0), 0))
        if state["is_closing"] and not state["queue"]:
            state.update(is_open=0, is_closing=0, number=state["number"] + 1)
            line = Line(state["line"], self._window)
            line.link = state["number"]
            state["line"] = line.value()
        written: str = state["line"]
        return written
