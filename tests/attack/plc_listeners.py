"""Listeners of PLCs, and of OPC UA: the same for the protocols of fieldbuses, each written by hand."""

import struct

from listeners import MIB, Listener, exactly, known


class OpcUa(Listener):
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


class S7(Listener):
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


class Modbus(Listener):
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


class Ads(Listener):
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


class RawTcp(Listener):
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


class TcpListen(Listener):
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
