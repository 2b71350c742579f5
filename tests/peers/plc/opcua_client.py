"""A client with nothing but OPC UA takes part in a session: the shear's program behind the session's own model."""

import asyncio
import sys

from asyncua import Client, ua

from shear import INPUTS, OUTPUTS, Shear

NAMESPACE = "urn:onescan:sdsp"
TYPES = {"AlignedCount": ua.VariantType.Int32, "Strokes": ua.VariantType.Int32}


async def main(url):
    async with Client(url) as client:
        index = await client.get_namespace_index(NAMESPACE)

        def node(path):
            return client.get_node(ua.NodeId(path, index))

        session = node("Session")
        await session.call_method(f"{index}:Pause")
        await session.call_method(f"{index}:Start")
        asked = [node("plc.Grant"), node("plc.GrantTime")] + [node(f"plc.Inputs.{name}") for name in INPUTS]
        given = [node(f"plc.Outputs.{name}") for name in OUTPUTS] + [node("plc.Done")]
        shear, done = Shear(), 0
        while True:
            # One request; nothing of it changes until the turn is done.
            grant, t_v, *values = await client.read_values(asked)
            if grant == done:
                if (await node("Session.State").read_value()) == "ended":
                    return
                continue
            if t_v > 0:
                shear.scan(t_v, dict(zip(INPUTS, values)))
            kinds = [TYPES.get(name, ua.VariantType.Boolean) for name in OUTPUTS]
            outputs = [ua.DataValue(ua.Variant(shear.out[name], kind)) for name, kind in zip(OUTPUTS, kinds)]
            await client.write_values(given, outputs + [ua.DataValue(ua.Variant(grant, ua.VariantType.UInt32))])
            done = grant


try:
    asyncio.run(main(sys.argv[1]))
except (ConnectionError, asyncio.TimeoutError, ua.UaError):
    pass  # The server ends with its session.
