"""Listeners of sessions and pages: what a client says at each and what it is answered, and what a stranger can make of it."""

import json
import os
import socket
import ssl
import struct

MIB = 1 << 20
PATIENCE_S = 5.0
HTTP = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: */*\r\n\r\n"
# A ClientHello of TLS 1.2 with one cipher suite and no extensions.
TLS = bytes.fromhex("16030100310100002d0303") + bytes(range(32)) + bytes.fromhex("000002c02f0100") + bytes(2)
UPGRADE = (b"Upgrade: websocket", b"Connection: Upgrade", b"Sec-WebSocket-Version: 13",
           b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==")


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


class Listener:
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


class Lobby(Listener):
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


class Page(Listener):
    """`run --web` and `view`: requests of a browser, and its web socket."""

    places = 128
    path = b"/api/session"

    def __init__(self, address):
        super().__init__(address)
        self.hello = self.http(b"GET /api/live", *UPGRADE)
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
        self.upgrade(sock, self.hello)

    @staticmethod
    def upgrade(sock, request):
        sock.sendall(request)
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


class Secured:
    """The same under TLS, with a token: strangers come as far as the first message of a handshake."""

    places = None
    # Set once the session has its certificate and its token.
    authority = token = None

    def __init__(self, address):
        super().__init__(address)
        outgoing = ssl.MemoryBIO()
        try:
            ssl.create_default_context().wrap_bio(ssl.MemoryBIO(), outgoing, server_hostname="localhost").do_handshake()
        except ssl.SSLWantReadError:
            pass
        plain, self.hello = self.hello, outgoing.read()
        self.halves = (self.hello[:-1], self.hello[:3], self.hello[:40], plain)
        self.endless = (b"\x16\x03\x01\xff\xff" + bytes(65536), plain + bytes(65536))
        self.endless_after_hello = (b"\x17\x03\x03\x40\x00" + bytes(16384),)

    def request(self, received):
        return self.hello

    def connect(self):
        return ssl.create_default_context(cafile=self.authority).wrap_socket(super().connect(), server_hostname=self.address[0])


class SecuredLobby(Secured, Lobby):
    def greet(self, sock):
        who = {"protocol": {"min": 1, "max": 1}, "agent": "anna", "role": "operator", "token": self.token}
        sock.sendall(self.framed({"hello": who}))
        self.expect(sock, "welcome")

    def ask(self, sock):
        sock.sendall(self.framed({"status": {}}))
        self.expect(sock, "status")


class SecuredPage(Secured, Page):
    def http(self, what, *lines):
        return super().http(what, b"Authorization: Bearer " + self.token.encode(), *lines)

    def greet(self, sock):
        self.upgrade(sock, self.http(b"GET /api/live", *UPGRADE))
