"""The doors: what a client says at each of them and what it is answered, and what a stranger can make of it."""

import json
import os
import socket
import struct

MIB = 1 << 20
PATIENCE_S = 5.0
HTTP = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: */*\r\n\r\n"
# A ClientHello of TLS 1.2 with one cipher suite and no extensions.
TLS = bytes.fromhex("16030100310100002d0303") + bytes(range(32)) + bytes.fromhex("000002c02f0100") + bytes(2)


def exactly(sock, count):
    """So many bytes that come."""
    data = bytearray()
    while len(data) < count:
        piece = sock.recv(count - len(data))
        if not piece:
            raise ConnectionError(f"closed after {len(data)} of {count} bytes")
        data += piece
    return bytes(data)


def known(condition, what):
    if not condition:
        raise ConnectionError(what)


class Door:
    """A listener. Of those who have greeted, so many at a time have a place that no stranger takes."""

    places = 0

    def __init__(self, address):
        host, _, port = address.rpartition(":")
        self.address = (host, int(port))
        self.host = f"{host}:{port}".encode()

    # What strangers say.
    hello = b""
    halves = ()
    endless = ()
    endless_after_hello = ()

    def request(self, received):
        """One more request of a client that was told this."""
        return b""

    def stray(self, data):
        """The same bytes, so that they are nobody's request."""
        return data

    # What a client does.
    def connect(self):
        sock = socket.create_connection(self.address, PATIENCE_S)
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        return sock

    def greet(self, sock):
        pass

    def ask(self, sock):
        raise NotImplementedError

    def visit(self):
        """A client that comes, asks and goes."""
        with self.connect() as sock:
            self.greet(sock)
            self.ask(sock)


class Lobby(Door):
    """`run --listen`, as an operator (server/PROTOCOL.md)."""

    places = 64

    @staticmethod
    def framed(message):
        body = b"J" + json.dumps(message).encode()
        return struct.pack("<I", len(body)) + body

    def __init__(self, address):
        super().__init__(address)
        who = {"protocol": {"min": 1, "max": 1}, "agent": "stranger"}
        self.hello = self.framed({"hello": {**who, "role": "operator"}})
        client = self.framed({"hello": {**who, "role": "client"}})
        long = struct.pack("<I", MIB) + b"J" + b" " * (MIB - 2)
        self.halves = (self.hello[: len(self.hello) // 2], client, self.hello[:4])
        self.endless = (struct.pack("<I", 0xFFFFFFFF) + b"J" + bytes(4096), long, client + long)
        self.endless_after_hello = (long, struct.pack("<I", 0xFFFFFFFF) + b"J")

    def request(self, received):
        return self.framed({"status": {}})

    def greet(self, sock):
        sock.sendall(self.hello)
        self.expect(sock, "welcome")

    def ask(self, sock):
        sock.sendall(self.request(b""))
        self.expect(sock, "status")

    @staticmethod
    def expect(sock, kind):
        (length,) = struct.unpack("<I", exactly(sock, 4))
        message = json.loads(exactly(sock, length)[1:])
        known(kind in message, f"{kind} expected, {message} came")


class Page(Door):
    """`run --web` and `view`: requests of a browser, and its web socket."""

    places = 128
    path = b"/api/session"

    def __init__(self, address):
        super().__init__(address)
        upgrade = (b"Upgrade: websocket", b"Connection: Upgrade", b"Sec-WebSocket-Version: 13",
                   b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==")
        self.hello = self.http(b"GET /api/live", *upgrade)
        unfinished = self.http(b"POST /api/login", b"Content-Length: 100")
        self.halves = (self.hello[:-2], self.hello[:20], unfinished)
        self.endless = (self.http(b"POST /api/login", b"Content-Length: 999999999999") + bytes(64 * 1024),
                        self.http(b"GET /")[:-2] + b"X: " + b"a" * 400_000,
                        self.http(b"POST /api/edit", b"Transfer-Encoding: chunked") + b"FFFFFFFF\r\n" + bytes(64 * 1024))
        self.endless_after_hello = (b"\x82\xff" + struct.pack(">Q", 1 << 62) + bytes(4) + bytes(64 * 1024),
                                    b"\x01\xfe" + struct.pack(">H", 60_000) + bytes(4) + b" " * 50_000)

    def http(self, what, *lines):
        return b"\r\n".join((what + b" HTTP/1.1", b"Host: " + self.host, *lines, b"", b""))

    def request(self, received):
        text = b'{"type": "nothing"}'
        return b"\x81" + bytes([0x80 | len(text)]) + bytes(4) + text

    def greet(self, sock):
        sock.sendall(self.hello)
        head = b""
        while b"\r\n\r\n" not in head:
            head += exactly(sock, 1)
        known(b" 101 " in head.splitlines()[0], f"not a web socket: {head.splitlines()[0]!r}")

    def ask(self, sock):
        """Its ping comes back among what a viewer is told."""
        ping = os.urandom(8)
        sock.sendall(b"\x89\x88" + bytes(4) + ping)
        while True:
            kind, length = exactly(sock, 2)
            if length & 0x7F > 125:
                wide = length & 0x7F == 127
                (length,) = struct.unpack(">Q" if wide else ">H", exactly(sock, 8 if wide else 2))
            payload = exactly(sock, length)
            if kind & 0x0F == 0x0A and payload == ping:
                return

    def get(self):
        with self.connect() as sock:
            sock.sendall(self.http(b"GET " + self.path, b"Connection: close"))
            answer = b""
            while piece := sock.recv(65536):
                answer += piece
        known(answer.startswith(b"HTTP/1.1 200 "), f"not a page: {answer[:60]!r}")
        return answer

    def visit(self):
        self.get()
        super().visit()


class Editor(Page):
    """`edit`: each request is answered, and nobody has a place."""

    places = None
    path = b"/api/edit"

    def __init__(self, address):
        super().__init__(address)
        self.hello = self.http(b"GET " + self.path)
        self.endless_after_hello = self.endless

    def request(self, received):
        return self.hello

    def visit(self):
        self.get()


class OpcUa(Door):
    """`--opcua`: HELLO, a secure channel without security, and its endpoints (OPC 10000-6 7.1)."""

    places = 48

    def __init__(self, address):
        super().__init__(address)
        self.url = self.text(b"opc.tcp://" + self.host + b"/")
        body = struct.pack("<5I", 0, 65536, 65536, 0, 0) + self.url
        hello = b"HELF" + struct.pack("<I", 8 + len(body)) + body
        policy = self.text(b"http://opcfoundation.org/UA/SecurityPolicy#None") + b"\xff" * 8
        opening = self.typed(446) + struct.pack("<3IiI", 0, 0, 1, -1, 3_600_000)
        open_channel = self.chunk(b"OPN", 0, policy + struct.pack("<2I", 1, 1) + opening)
        self.hello = hello + open_channel
        self.halves = (hello[:8], hello[:20], hello, self.hello[:-10])
        self.endless = (b"HELF\xff\xff\xff\xff", b"HELF\x00\x20\x00\x00" + bytes(4096),
                        hello + b"OPNF\xff\xff\xff\xff" + bytes(65536), hello + b"OPNF\xff\xff\x00\x00" + bytes(60_000))
        self.endless_after_hello = (b"MSGC\xff\xff\x00\x00" + bytes(60_000), b"MSGF\xff\xff\xff\xff" + bytes(65536))

    @staticmethod
    def text(value):
        return struct.pack("<i", len(value)) + value

    @staticmethod
    def chunk(kind, channel, body):
        return kind + b"F" + struct.pack("<2I", 12 + len(body), channel) + body

    @staticmethod
    def typed(number):
        """The type of a request, and its head."""
        return struct.pack("<BBH", 1, 0, number) + bytes(2) + struct.pack("<qIIiI", 0, 1, 0, -1, 5000) + bytes(3)

    def request(self, received):
        """GetEndpoints over the channel that was opened."""
        at = received.find(b"OPNF")
        if at < 0 or len(received) < at + 135:
            return b""
        (channel,) = struct.unpack_from("<I", received, at + 8)
        # Behind the policy, two certificates, sequence, type, the response's head and a version.
        (policy,) = struct.unpack_from("<i", received, at + 12)
        (token,) = struct.unpack_from("<I", received, at + 16 + policy + 8 + 8 + 4 + 24 + 4 + 4)
        self.sequence = getattr(self, "sequence", 1) + 1
        head = struct.pack("<3I", token, self.sequence, self.sequence)
        return self.chunk(b"MSG", channel, head + self.typed(428) + self.url + b"\xff" * 8)

    @staticmethod
    def message(sock):
        head = exactly(sock, 8)
        (size,) = struct.unpack_from("<I", head, 4)
        known(8 <= size <= 1 << 20, f"a chunk of {size} bytes")
        return head + exactly(sock, size - 8)

    def greet(self, sock):
        sock.sendall(self.hello)
        known(self.message(sock)[:3] == b"ACK", "no acknowledgement")
        self.sequence = 1
        self.opened = self.message(sock)
        known(self.opened[:3] == b"OPN", "no secure channel")

    def ask(self, sock):
        sock.sendall(self.request(self.opened))
        answer = self.message(sock)
        known(answer[:3] == b"MSG" and struct.unpack_from("<H", answer, 26)[0] == 431, f"no endpoints: {answer[:40]!r}")


class S7(Door):
    """`plc --s7`: the block of the PLC, read."""

    places = 48

    def __init__(self, address):
        super().__init__(address)
        connect = bytes.fromhex("0300001611e00000000100c1020100c2020102c0010a")
        setup = self.telegram(bytes.fromhex("32010000000100080000f0000001000101e0"))
        self.hello = connect + setup
        part = b"\x03\x00\x04\x00\x02\xf0\x00" + bytes(1017)
        self.halves = (connect[:-1], connect[:11], connect[:4])
        self.endless = (b"\x03\x00\xff\xff" + bytes(65_000), b"\x03\x00\xff\xff\x02\xf0\x00" + bytes(65_528) * 3, part * 64)
        self.endless_after_hello = (part * 64, b"\x03\x00\xff\xff" + bytes(65_000))

    @staticmethod
    def telegram(message):
        return b"\x03\x00" + struct.pack(">H", 7 + len(message)) + b"\x02\xf0\x80" + message

    def request(self, received):
        return self.telegram(bytes.fromhex("320100000002000e0000" "0401120a1002" "001c" "0002" "84000000"))

    def greet(self, sock):
        sock.sendall(self.hello)
        for _ in range(2):
            self.message(sock)

    def message(self, sock):
        head = exactly(sock, 4)
        return head + exactly(sock, struct.unpack(">H", head[2:])[0] - 4)

    def ask(self, sock):
        sock.sendall(self.request(b""))
        answer = self.message(sock)
        known(answer[21:22] == b"\xff" and len(answer) == 53, f"no block: {answer!r}")


class Modbus(Door):
    """`plc --modbus`: five registers of the PLC, read."""

    places = 48

    def __init__(self, address):
        super().__init__(address)
        self.hello = self.request(b"")
        self.halves = (self.hello[:6], self.hello[:-1])
        self.endless = (b"\x00\x01\x00\x00\xff\xff" + bytes(65_000), b"\x00\x01\x00\x00\x00\x00" + bytes(4096))
        self.endless_after_hello = self.endless

    def request(self, received):
        return struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 1000, 5)

    def ask(self, sock):
        sock.sendall(self.request(b""))
        answer = exactly(sock, 9)
        known(answer[7] == 3, f"refused: {answer!r}")
        exactly(sock, 10)


class Ads(Door):
    """`plc --ads`: a variable, read by its handle."""

    places = 48

    def __init__(self, address):
        super().__init__(address)
        name = b"Shear.Strokes\0"
        self.hello = self.frame(9, struct.pack("<4I", 0xF003, 0, 4, len(name)) + name)
        self.halves = (self.hello[:3], self.hello[:20], self.hello[:-1])
        head = self.hello[6:26]
        self.endless = (bytes(2) + b"\xff\xff\xff\xff" + head, bytes(2) + struct.pack("<I", 32 + MIB) + bytes(MIB),
                        bytes(2) + struct.pack("<I", 5) + head)
        self.endless_after_hello = self.endless[:2]
        self.handle = 1

    @staticmethod
    def frame(command, data):
        ends = bytes([127, 0, 0, 1, 1, 1]) + struct.pack("<H", 851) + bytes([127, 0, 0, 2, 1, 1]) + struct.pack("<H", 40_000)
        return bytes(2) + struct.pack("<I", 32 + len(data)) + ends + struct.pack("<2H3I", command, 4, len(data), 0, 1) + data

    def request(self, received):
        return self.frame(2, struct.pack("<3I", 0xF005, self.handle, 4))

    def answer(self, sock):
        head = exactly(sock, 6)
        data = exactly(sock, struct.unpack_from("<I", head, 2)[0])[32:]
        known(len(data) == 12 and data[:8] == struct.pack("<2I", 0, 4), f"refused: {data!r}")
        return struct.unpack_from("<I", data, 8)[0]

    def greet(self, sock):
        sock.sendall(self.hello)
        self.handle = self.answer(sock)

    def ask(self, sock):
        sock.sendall(self.request(b""))
        self.answer(sock)


class SessionAds(Ads):
    """`run --ads`: the same, of a step boundary."""

    places = 16


class RawTcp(Door):
    """`plc --tcp`: whoever sends a whole block has the PLC, so no stranger here sends one; who listens is sent the PLC's."""

    TO_PLC, FROM_PLC = 44, 28

    def __init__(self, address):
        super().__init__(address)
        self.halves = (self.stray(bytes(self.TO_PLC - 1)), b"\0")
        self.endless = (self.stray(bytes(MIB)),)
        self.endless_after_hello = self.endless

    def stray(self, data):
        """Bits in the reserve, which the scenario checks."""
        data = bytearray(data)
        for at in range(16, len(data), self.TO_PLC):
            data[at] |= 0x10
        return bytes(data)

    def ask(self, sock):
        exactly(sock, self.FROM_PLC)


class TcpListen(Door):
    """`tcp-listen://`: the PLC is in, and everybody else is closed."""

    places = None

    def __init__(self, address):
        super().__init__(address)
        self.hello = bytes(28)
        self.halves = (bytes(27), b"\0")
        self.endless = (bytes(MIB),)
        self.endless_after_hello = self.endless

    def request(self, received):
        return self.hello
