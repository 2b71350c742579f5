"""The client's side of the protocol, version 1. Section numbers are those of PROTOCOL.md.

    with LockstepClient("127.0.0.1", 4840) as client:      # leaving the block closes the connection
        welcome = client.connect("my simulator 2.3")
        client.join("plant", welcome["step_ns"], reads=[("A", "BOOL")], writes=[("B", "LREAL")])
        end = client.run(MyParticipant())

`Simulation` is the easier way for most.
"""
from __future__ import annotations

import json
import socket
import ssl
import struct
from abc import ABC, abstractmethod
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple

from .errors import LostServer, ProtocolError, Refused, SessionEnded, SessionFailed
from .values import Value, layout, pack, unpack

Fields = Dict[str, Any]
"""The fields of a message, or values by the name of their signal."""

Signals = Sequence[Tuple[str, str]]
"""Names and types."""

_MESSAGES = {  # kind -> the fields it must have, those it may have
    "welcome": ({"protocol", "agent", "step_ns", "frame_bytes_max", "signals"}, set()),
    "refused": ({"message"}, set()),
    "joined": ({"input_bytes", "inputs", "output_bytes", "outputs"}, set()),
    "setup": (set(), set()), "save": (set(), set()), "restore": ({"t_v_ns", "steps"}, set()),
    "end": ({"status", "t_v_ns"}, {"client", "state", "cause"})}


def parse(body: bytes) -> Tuple[str, Fields]:
    """Kind and fields of a server's message. `refused` and `end`, which nothing follows, are raised."""
    try:
        (kind, fields), = json.loads(body.decode("utf-8")).items()
        must, may = _MESSAGES[kind]
        if not must <= fields.keys() <= must | may:
            raise ValueError(f"wrong fields: {fields}")
    except (ValueError, KeyError, AttributeError, TypeError, RecursionError) as error:
        raise ProtocolError(f"no message of a server: {body[:200]!r} ({error!r})") from error
    if kind == "refused":
        raise Refused(fields["message"])
    if kind == "end":
        raise (SessionEnded if fields["status"] in ("completed", "stopped") else SessionFailed)(fields)
    return kind, fields


class Participant(ABC):
    """What takes part: a function of its state, its inputs and `t_v` (section 6). An exception is a fault."""

    wake_ns: int = 0
    """A turn may set it: when the next one is wanted, 0 for one period on (section 3.3)."""

    @abstractmethod
    def setup(self) -> Mapping[str, Value]:
        """Take the initial state, whatever was before, and give the initial outputs."""

    @abstractmethod
    def turn(self, t_v_ns: int, inputs: Dict[str, Value]) -> Mapping[str, Value]:
        """Run the turn that ends at `t_v_ns` and give all outputs."""

    @abstractmethod
    def save(self) -> bytes:
        """The complete state (section 3.4)."""

    @abstractmethod
    def restore(self, state: bytes) -> None:
        """Take the state that `save` once gave."""


def _slots(signals: Signals) -> Tuple[int, List[Fields]]:
    """Size and layout that follow from a list of signals (section 3.1)."""
    total, result = 0, []
    for signal, type_name in signals:
        size = layout(type_name)[0].size
        result.append({"name": signal, "type": type_name, "offset": total, "size": size})
        total += size
    return total, result


class LockstepClient:
    """One connection to a server: `connect`, `join` and `run`, in this order."""

    def __init__(self, host: str, port: int, token: Optional[str] = None, tls_ca: Optional[str] = None,
                 tls_own: Optional[Tuple[str, str]] = None) -> None:
        """`token` is shown if the session asks for one; with `tls_ca`, a file of certificates, it speaks TLS and
        trusts what these have signed (section 7). `tls_own`, the files of a certificate and its key, is shown in
        place of a token."""
        self._address, self._sock = (host, port), socket.socket()
        self._token, self._tls_ca, self._tls_own = token, tls_ca, tls_own
        self._limit = 1 << 26  # section 2: what a client takes and, once it has joined, may send
        self._reads: Signals = []
        self._writes: Signals = []
        self._input_bytes = 0
        self._last: Optional[Tuple[int, int]] = None  # sequence and t_v of the grant before; None: not set up

    def __enter__(self) -> LockstepClient:
        return self

    def __exit__(self, *_: object) -> None:
        self._sock.close()

    def _send_raw(self, data: bytes) -> None:
        """Send bytes. An error is left to the next read, which may still find the server's `end`."""
        try:
            self._sock.sendall(data)
        except OSError:
            pass

    def _send(self, frame_type: bytes, body: bytes) -> None:
        """Send a frame (section 2)."""
        if 1 + len(body) > self._limit:
            raise ValueError(f"a frame of length {1 + len(body)}, the limit is {self._limit}")
        self._send_raw(struct.pack("<I", 1 + len(body)) + frame_type + body)

    def _send_message(self, kind: str, fields: Fields) -> None:
        self._send(b"J", json.dumps({kind: fields}).encode("utf-8"))

    def _read(self, count: int) -> bytes:
        data = bytearray()
        try:
            while len(data) < count:
                part = self._sock.recv(min(count - len(data), 1 << 20))
                if not part:
                    raise LostServer("the server closed the connection without `end`")
                data += part
        except OSError as error:
            raise LostServer(f"the connection to the server is gone: {error}") from error
        return bytes(data)

    def _read_frame(self) -> Tuple[bytes, bytes]:
        """Type and body of the next frame (section 2)."""
        length = int.from_bytes(self._read(4), "little")
        if not 1 <= length <= self._limit:
            raise ProtocolError(f"a frame of length {length}, the limit is {self._limit}")
        return self._read(1), self._read(length - 1)

    def _expect(self, expected: str) -> Fields:
        """The next message of the handshake (section 3.1)."""
        frame_type, body = self._read_frame()
        kind, fields = parse(body) if frame_type == b"J" else (f"frame {frame_type!r}", {})
        if kind != expected:
            raise ProtocolError(f"`{kind}` in place of `{expected}`")
        return fields

    def connect(self, agent: str = "onescan-client 0.2.0") -> Fields:
        """Connect, say `hello` and give the fields of `welcome` (section 3.1)."""
        try:
            self._sock.close()
            self._sock = socket.create_connection(self._address, timeout=5.0)  # until joined
            self._sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            if self._tls_ca is not None:
                context = ssl.create_default_context(cafile=self._tls_ca)
                context.minimum_version = ssl.TLSVersion.TLSv1_2
                if self._tls_own is not None:
                    context.load_cert_chain(*self._tls_own)
                self._sock = context.wrap_socket(self._sock, server_hostname=self._address[0])
        except OSError as error:
            raise LostServer(f"no connection to {self._address}: {error}") from error
        hello: Fields = {"protocol": {"min": 1, "max": 1}, "role": "client", "agent": agent}
        if self._token is not None:
            hello["token"] = self._token
        self._send_message("hello", hello)
        welcome = self._expect("welcome")
        if welcome["protocol"] != 1:
            raise ProtocolError(f"the server chose version {welcome['protocol']}")
        self._limit = welcome["frame_bytes_max"]
        return welcome

    def join(self, name: str, period_ns: int, reads: Signals, writes: Signals) -> None:
        """Join with these signals and check that `joined` lays them out as section 3.1 says."""
        self._send_message("join", {"name": name, "period_ns": period_ns,
                                    "reads": [{"name": n, "type": t} for n, t in reads],
                                    "writes": [{"name": n, "type": t} for n, t in writes]})
        joined = self._expect("joined")
        if (joined["input_bytes"], joined["inputs"], joined["output_bytes"], joined["outputs"]) != (
                *_slots(reads), *_slots(writes)):
            raise ProtocolError(f"a layout that does not follow from `join`: {joined}")
        self._reads, self._writes, self._input_bytes = list(reads), list(writes), joined["input_bytes"]
        self._sock.settimeout(None)  # section 4: the session may be slow or paused

    def run(self, participant: Participant) -> Fields:
        """Take part to the end (sections 3.3 to 3.5); gives the fields of `end` if the session did not fail."""
        try:
            while True:
                frame_type, body = self._read_frame()
                if frame_type == b"G" and self._last is not None:
                    self._grant(participant, self._last, body)
                elif frame_type == b"J":
                    self._message(participant, *parse(body))
                else:
                    raise ProtocolError(f"a frame of type {frame_type!r} has no place here")
        except SessionFailed:
            raise
        except SessionEnded as ended:
            return ended.end
        finally:
            self._sock.close()

    def _message(self, participant: Participant, kind: str, fields: Fields) -> None:
        if kind == "setup":  # the first one, or a reset
            outputs = self._ask(participant.setup)
            self._last = (0, 0)
            self._send_turn(0, 0, 0, outputs)
        elif kind == "save" and self._last is not None:
            try:
                self._send(b"S", participant.save())
            except Exception as error:  # this fault does not end the session (section 3.4)
                self._send_fault(error)
        elif kind == "restore" and self._last is None:
            frame_type, state = self._read_frame()
            if frame_type != b"S":
                raise ProtocolError(f"{parse(state) if frame_type == b'J' else frame_type!r} in place of a state")
            try:
                participant.restore(state)
            except Exception as error:
                self._send_fault(error)
                raise LostServer(f"left: the state cannot be taken back: {error}") from error
            self._last = (fields["steps"], fields["t_v_ns"])
            self._send_message("restored", {})
        else:
            raise ProtocolError(f"`{kind}` has no place here")

    def _grant(self, participant: Participant, last: Tuple[int, int], body: bytes) -> None:
        """One turn, in the order of section 3.3."""
        if len(body) != 16 + self._input_bytes:
            raise ProtocolError(f"a grant of {len(body)} bytes in place of 16 + {self._input_bytes}")
        sequence, t_v_ns = struct.unpack_from("<QQ", body)
        if sequence <= last[0] or t_v_ns <= last[1]:
            raise ProtocolError(f"a grant of {(sequence, t_v_ns)} after {last}")
        self._last = (sequence, t_v_ns)
        inputs: Dict[str, Value] = {}
        offset = 16
        for name, type_name in self._reads:
            end = offset + layout(type_name)[0].size
            inputs[name], offset = unpack(type_name, body[offset:end]), end
        participant.wake_ns = 0
        outputs = self._ask(participant.turn, t_v_ns, inputs)
        self._send_turn(sequence, t_v_ns, participant.wake_ns, outputs)

    def _ask(self, action: Callable[..., Mapping[str, Value]], *arguments: Any) -> bytes:
        """The encoded outputs of `setup` or `turn`. An exception becomes a `fault` (section 3.3)."""
        try:
            outputs = action(*arguments)
            if outputs.keys() != {name for name, _ in self._writes}:
                raise ValueError(f"the outputs are {list(outputs)} and should be {self._writes}")
            return b"".join(pack(type_name, outputs[name]) for name, type_name in self._writes)
        except Exception as error:
            self._send_fault(error)
            raise SessionFailed({"status": "failed", "cause": {"fault": {"message": str(error)}}}) from error

    def _send_turn(self, sequence: int, t_v_ns: int, wake_ns: int, outputs: bytes) -> None:
        self._send(b"T", struct.pack("<QQQ", sequence, t_v_ns, wake_ns) + outputs)

    def _send_fault(self, error: Exception) -> None:
        self._send_message("fault", {"message": str(error) or type(error).__name__})
