"""A PLC on a `python-snap7` server whose data blocks are those of an SCL source, which is the only argument.

The blocks are laid out from their declarations by the rules of standard access. Every byte behind them is a trap, as is
a block that is somebody else's: when one changes, this ends. Prints its port; runs until it is ended.
"""

import re
import socket
import struct
import sys
import time
from pathlib import Path

from snap7.server import Server
from snap7.type import SrvArea

from shear import INPUTS, OUTPUTS, WORDS_IN, WORDS_OUT, Plc

FORMATS = {"SInt": "b", "Int": "h", "DInt": "i", "LInt": "q", "USInt": "B", "UInt": "H", "UDInt": "I", "ULInt": "Q"}
FORMATS |= {"Byte": "B", "Word": "H", "DWord": "I", "LWord": "Q", "Real": "f", "LReal": "d"}
TRAP = 0xA5
BEHIND = 32


class Block:
    """A data block of standard access."""

    def __init__(self, source, name):
        found = re.search(rf'DATA_BLOCK "{name}" // number (\d+)\n(.*?)END_DATA_BLOCK', source, re.S)
        self.number, body = int(found[1]), found[2]
        assert "S7_Optimized_Access := 'FALSE'" in body
        self.places, self.size, bit = {}, 0, 0
        for member, ty in re.findall(r"^ +(\w+) : (\w+);", body, re.M):
            if ty == "Bool":
                if bit in (0, 8):
                    bit, self.size = 0, self.size + 1
                self.places[member] = (ty, self.size - 1, bit)
                bit += 1
                continue
            bit, width = 0, struct.calcsize(FORMATS[ty])
            self.size += self.size % 2 if width > 1 else 0
            self.places[member] = (ty, self.size, None)
            self.size += width
        self.size += self.size % 2
        self.bytes = bytearray([0] * self.size + [TRAP] * BEHIND)

    def get(self, block, member):
        ty, at, bit = self.places[member]
        return block[at] >> bit & 1 if bit is not None else struct.unpack_from(">" + FORMATS[ty], block, at)[0]

    def put(self, member, value):
        ty, at, bit = self.places[member]
        if bit is None:
            struct.pack_into(">" + FORMATS[ty], self.bytes, at, value)
        else:
            self.bytes[at] = self.bytes[at] & ~(1 << bit) | bool(value) << bit

    def is_whole(self):
        return self.bytes[self.size :] == bytearray([TRAP] * BEHIND)


def copies(source, pattern):
    """The member of a block for each variable, as the copies name them."""
    return {f"{block}.{member}": copied for block, member, copied in re.findall(pattern, source)}


def main():
    source = Path(sys.argv[1]).read_text()
    to_plc, from_plc = Block(source, "SDSP_ToPLC"), Block(source, "SDSP_FromPLC")
    taken = copies(source, r'"(\w+)"\.(\w+) := "SDSP_ToPLC"\.(\w+);')
    given = {
        f"{block}.{member}": copied
        for copied, block, member in re.findall(r'"SDSP_FromPLC"\.(\w+) := "(\w+)"\.(\w+);', source)
    }
    layout = int(re.search(r"SDSP_Layout : UDInt := (\d+);", source)[1])
    foreign = bytearray([TRAP] * 100)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = Server(log=False)
    server.register_area(SrvArea.DB, 1, foreign)
    for block in (to_plc, from_plc):
        server.register_area(SrvArea.DB, block.number, block.bytes)
    server.start(tcp_port=port)
    print(port, flush=True)
    plc = Plc()
    while to_plc.is_whole() and from_plc.is_whole() and foreign == bytearray([TRAP] * 100):
        block = bytes(to_plc.bytes)
        inputs = {path: to_plc.get(block, taken[path]) for path in INPUTS}
        words = {word: to_plc.get(block, word) for word in WORDS_IN}
        shown = plc.cycle(inputs | words)
        for path in OUTPUTS:
            from_plc.put(given[path], shown[path])
        from_plc.put("SDSP_Layout", layout)
        # Outputs before the words, and what is done last: who sees it sees its outputs.
        for word in ("SDSP_Answer", "SDSP_Joined", "SDSP_Done"):
            from_plc.put(word, shown[word])
        time.sleep(0.001)
    sys.exit("a byte was written that is not the gateway's")


main()
