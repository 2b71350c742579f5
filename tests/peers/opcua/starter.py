"""An operator who starts a session whose scenario says `start`, with nothing but an OPC UA client.

    starter.py URL SIGNAL VALUE
"""

import asyncio
import sys

from asyncua import Client


async def main(url, signal, value):
    async with Client(url, timeout=120) as client:
        own = await client.get_namespace_index("urn:onescan:session")
        session = await client.nodes.objects.get_child(f"{own}:Session")
        member = {}
        for node in await session.get_children():
            member[(await node.read_browse_name()).Name] = node

        async def read(*names):
            return await client.read_values([member[name] for name in names])

        while (await read("State"))[0] == 0:
            pass
        await session.call_method(member["Start"])
        print("held, state, steps", await read("Held", "State", "StepCount"))
        await session.call_method(member["Write"], signal, value)
        while (await read("State"))[0] != 6:
            pass
        print("ended after", *await read("StepCount"))


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
