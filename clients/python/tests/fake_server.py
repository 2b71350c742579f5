"""The server's side of a session, as a script of what it sends: one client, one thread."""
import json
import socket
import struct
import threading
from typing import Any, Callable, Dict, List, Tuple


class FakeServer:
    """Welcomes one client, then does what `session` says."""

    def __init__(self, session: Callable[["FakeServer"], None]) -> None:
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = "127.0.0.1:%d" % self._listener.getsockname()[1]
        self.join: Dict[str, Any] = {}
        self._session = session
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def _serve(self) -> None:
        self._socket, _ = self._listener.accept()
        with self._socket, self._listener:
            self.receive()
            self.message("welcome", {"protocol": 1, "agent": "fake", "step_ns": 10_000_000,
                                     "frame_bytes_max": 1 << 20, "signals": []})
            self.join = json.loads(self.receive()[1])["join"]
            self._session(self)

    def finish(self) -> None:
        self._thread.join(10)

    def accept(self, sizes: Dict[str, int]) -> None:
        """Answers `joined`, with this size for each type."""
        def slots(ports: List[Dict[str, Any]]) -> Tuple[int, List[Dict[str, Any]]]:
            total, found = 0, []
            for port in ports:
                found.append({**port, "offset": total, "size": sizes[port["type"]]})
                total += sizes[port["type"]]
            return total, found
        (input_bytes, inputs), (output_bytes, outputs) = slots(self.join["reads"]), slots(self.join["writes"])
        self.message("joined", {"input_bytes": input_bytes, "inputs": inputs,
                                "output_bytes": output_bytes, "outputs": outputs})

    def message(self, kind: str, fields: Dict[str, Any]) -> None:
        self.frame(b"J", json.dumps({kind: fields}).encode())

    def grant(self, sequence: int, t_v_ns: int, inputs: bytes) -> bytes:
        """Grants a turn; the outputs of its answer."""
        self.frame(b"G", struct.pack("<QQ", sequence, t_v_ns) + inputs)
        return self.receive()[1][24:]

    def frame(self, kind: bytes, body: bytes) -> None:
        self._socket.sendall(struct.pack("<I", 1 + len(body)) + kind + body)

    def receive(self) -> Tuple[bytes, bytes]:
        (length,) = struct.unpack("<I", self._exactly(4))
        data = self._exactly(length)
        return data[:1], data[1:]

    def _exactly(self, count: int) -> bytes:
        data = b""
        while len(data) < count:
            part = self._socket.recv(count - len(data))
            if not part:
                raise EOFError("the client is gone")
            data += part
        return data
