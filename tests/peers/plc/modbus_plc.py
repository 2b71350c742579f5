"""A PLC on a `pymodbus` server. Prints its port; runs until it is ended."""

import asyncio
import struct

from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from shear import INPUTS, OUTPUTS, WORDS_IN, WORDS_OUT, Plc

# struct's letters; everything big-endian, the high word first.
FORMS = {
    "Shear.Position_1": ">d",
    "Shear.Position_2": ">d",
    "SDSP_TV": ">q",
    "SDSP_Answer": ">h",
    "Alignment.AlignedCount": ">i",
    "Shear.Strokes": ">i",
}


# The server's own reads and writes: it has one device for all units.
UNIT = 0


def form(name):
    return FORMS.get(name, ">I" if name.startswith("SDSP") else ">H")


def places(names, at):
    found = {}
    for name in names:
        found[name] = at
        at += struct.calcsize(form(name)) // 2
    return found


TO_PLC = places(INPUTS + WORDS_IN, 0)
FROM_PLC = places(WORDS_OUT + OUTPUTS, 1000)


async def main():
    registers = SimData(0, count=2000, values=0, datatype=DataType.REGISTERS)
    server = ModbusTcpServer(SimDevice(0, simdata=registers), address=("127.0.0.1", 0))
    await server.serve_forever(background=True)
    print(server.transport.sockets[0].getsockname()[1], flush=True)
    plc = Plc()
    while True:
        taken = {}
        for name, at in TO_PLC.items():
            count = struct.calcsize(form(name)) // 2
            words = struct.pack(f">{count}H", *await server.async_getValues(UNIT, 3, at, count))
            taken[name] = struct.unpack(form(name), words)[0]
        for name, value in plc.cycle(taken).items():
            packed = struct.pack(form(name), value)
            words = list(struct.unpack(f">{len(packed) // 2}H", packed))
            await server.async_setValues(UNIT, 16, FROM_PLC[name], words)
        await asyncio.sleep(0.001)


asyncio.run(main())
