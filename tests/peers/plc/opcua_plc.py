"""A PLC on an `asyncua` server. Prints its port; runs until it is ended."""

import asyncio
import socket

from asyncua import Server, ua

from shear import INPUTS, OUTPUTS, WORDS_IN, WORDS_OUT, Plc

TYPES = {
    "Shear.Position_1": ua.VariantType.Double,
    "Shear.Position_2": ua.VariantType.Double,
    "SDSP_TV": ua.VariantType.Int64,
    "SDSP_Answer": ua.VariantType.Int16,
    "Alignment.AlignedCount": ua.VariantType.Int32,
    "Shear.Strokes": ua.VariantType.Int32,
}


def type_of(name):
    return TYPES.get(name, ua.VariantType.UInt32 if name.startswith("SDSP") else ua.VariantType.Boolean)


async def main():
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    server = Server()
    await server.init()
    server.set_endpoint(f"opc.tcp://127.0.0.1:{port}/")
    server.set_security_policy([ua.SecurityPolicyType.NoSecurity])
    index = await server.register_namespace("urn:onescan:plc:variables")
    folder = await server.nodes.objects.add_folder(index, "PLC")
    nodes = {}
    for name in INPUTS + WORDS_IN + WORDS_OUT + OUTPUTS:
        kind = type_of(name)
        zero = False if kind == ua.VariantType.Boolean else 0.0 if kind == ua.VariantType.Double else 0
        nodes[name] = await folder.add_variable(ua.NodeId(name, index), name, zero, kind)
        if name in INPUTS + WORDS_IN:
            await nodes[name].set_writable()
    plc = Plc()
    async with server:
        print(port, flush=True)
        while True:
            # Words first: inputs that are read behind a grant are those of the grant.
            taken = {name: await nodes[name].read_value() for name in reversed(INPUTS + WORDS_IN)}
            given = plc.cycle(taken)
            for name in OUTPUTS + WORDS_OUT:
                await nodes[name].write_value(ua.Variant(given[name], type_of(name)))
            await asyncio.sleep(0.001)


asyncio.run(main())
