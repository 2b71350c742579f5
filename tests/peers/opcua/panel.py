"""An operator of a session with nothing but an OPC UA client.

    panel.py URL
"""

import asyncio
import sys

from asyncua import Client, ua


async def main(url):
    async with Client(url, timeout=120) as client:
        types = await client.get_namespace_index("urn:onescan:lockstep")
        own = await client.get_namespace_index("urn:onescan:session")
        session = await client.nodes.objects.get_child(f"{own}:Session")
        member = {}
        for node in await session.get_children():
            member[(await node.read_browse_name()).Name] = node

        async def call(name, *arguments):
            try:
                await session.call_method(member[name], *arguments)
                return "Good"
            except ua.UaStatusCodeError as error:
                return type(error).__name__

        async def read(*names):
            return await client.read_values([member[name] for name in names])

        async def signal(name):
            return await (await member["Signals"].get_child(f"{own}:{name}")).read_value()

        print("Pause", await call("Pause"))
        before, held = await read("StepCount", "Held")
        for _ in range(5):
            assert await call("Step") == "Good"
        # A step that is asked for is done when the next wish is taken.
        print("Reset", await call("Reset"))
        print("Pause", await call("Pause"))
        steps, t_v = await read("StepCount", "VirtualTime")
        print("held", held, "steps", steps, "t_v", t_v, "step", *await read("TimeStep"))
        print("Force", await call("Force", "Sensor_1", "TRUE"))
        for _ in range(3):
            assert await call("Step") == "Good"
        print("Force of no signal", await call("Force", "Senosr_1", "TRUE"))
        print("Write of no value", await call("Write", "Strokes", "many"))
        print("Write of too few", await call("Write", "Strokes"))
        print("Release", await call("Release", "Sensor_1"))
        print("Release again", await call("Release", "Sensor_1"))
        steps, t_v, digest = await read("StepCount", "VirtualTime", "Digest")
        print("steps", steps, "t_v", t_v, "digest of", len(digest), "characters", "Sensor_1", await signal("Sensor_1"))
        print("Start", await call("Start"))
        while (await read("StepCount"))[0] < 10:
            pass
        print("Stop", await call("Stop"))
        while (await read("State"))[0] != 6:
            pass
        print("Pause", await call("Pause"))


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
