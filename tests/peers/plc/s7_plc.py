"""A PLC on a `python-snap7` server: DB1 to the PLC, DB2 from it. Prints its port; runs until it is ended."""

import socket
import struct
import time

from snap7.server import Server
from snap7.type import SrvArea

from shear import INPUTS, OUTPUTS, WORDS_IN, WORDS_OUT, Plc


def main():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    to_plc, from_plc = bytearray(38), bytearray(24)
    server = Server(log=False)
    server.register_area(SrvArea.DB, 1, to_plc)
    server.register_area(SrvArea.DB, 2, from_plc)
    server.start(tcp_port=port)
    print(port, flush=True)
    plc = Plc()
    while True:
        block = bytes(to_plc)
        p1, p2 = struct.unpack_from(">dd", block, 0)
        bits = block[16]
        words = struct.unpack_from(">IIqI", block, 18)
        taken = dict(zip(INPUTS, (p1, p2, *(bits >> bit & 1 for bit in range(4))))) | dict(zip(WORDS_IN, words))
        given = plc.cycle(taken)
        bits = sum(given[name] << bit for bit, name in enumerate(OUTPUTS[:5]))
        outputs = struct.pack(">Bxii", bits, given["Alignment.AlignedCount"], given["Shear.Strokes"])
        # Outputs before the words: who sees a grant done sees its outputs.
        from_plc[14:24] = outputs
        from_plc[0:14] = struct.pack(">IIhI", *(given[name] for name in WORDS_OUT))
        time.sleep(0.001)


main()
