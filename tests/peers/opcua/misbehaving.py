"""The shear's PLC as an OPC UA client that does everything wrong once, and says how it is refused.

    misbehaving.py URL
"""

import asyncio
import sys

from asyncua import ua
from participant import Plc

from lockstep import ENDED, Place, answer, connected


async def wrong(place, stranger, grant):
    """Everything that is refused while `grant` is under way."""
    u64, name, output = ua.VariantType.UInt64, *place.outputs[0][:2]
    tries = {
        "an answer to the grant before": ([place.Done], [ua.Variant(grant - 1, u64)]),
        "an answer to an old grant": ([place.Done], [ua.Variant(grant - 2, u64)]),
        "an answer to the next grant": ([place.Done], [ua.Variant(grant + 1, u64)]),
        "Done of another type": ([place.Done], [ua.Variant(grant, ua.VariantType.Int32)]),
        "Done as a list": ([place.Done], [ua.Variant([grant], u64)]),
        "an input": ([place.inputs[0][1]], [ua.Variant(1.5, place.inputs[0][2])]),
        "the grant": ([place.Grant], [ua.Variant(grant, u64)]),
        "Start taken back": ([place.Start], [False]),
        "an output of another type, and the answer":
            ([output, place.Done], [ua.Variant("text", ua.VariantType.String), ua.Variant(grant, u64)]),
    }
    for what, (nodes, values) in tries.items():
        print(f"{what}: {', '.join(await place.write(nodes, values))}")
    print(f"a stranger starts: {', '.join(await stranger.write([stranger.Start], [True]))}")
    print(f"a stranger answers: {await stranger.done(grant)}")
    print(f"a stranger writes {name}: {', '.join(await stranger.write([stranger.outputs[0][1]], [True]))}")
    for what, outputs in (("too few outputs", [True]), ("no values", [None] * len(place.outputs))):
        arguments = [ua.Variant(grant, u64), ua.Variant(0, ua.VariantType.Int64),
                     ua.Variant([ua.Variant(value) for value in outputs], ua.VariantType.Variant, is_array=True),
                     ua.Variant(10, ua.VariantType.UInt32)]
        try:
            await place.node.call_method(place.Turn, *arguments)
        except ua.UaStatusCodeError as error:
            print(f"Turn with {what}: {type(error).__name__}")


async def main(url):
    async with connected(url) as client, connected(url) as other:
        place, stranger = await Place(client, "plc").find(), await Place(other, "plc").find()
        print(f"an answer before the start: {await place.done(1)}")
        await place.start()
        print(f"the start again: {', '.join(await place.write([place.Start], [True]))}")
        who, last = Plc(), 0
        nodes = [place.State, place.Grant, place.GrantTime] + [node for _, node, _ in place.inputs]
        while True:
            state, grant, t_v_ns, *inputs = await client.read_values(nodes)
            if state == ENDED:
                break
            if grant == last:
                continue
            last = grant
            outputs = answer(who, t_v_ns, dict(zip((name for name, _, _ in place.inputs), inputs)))
            if grant == 7:
                await wrong(place, stranger, grant)
            where = [node for _, node, _ in place.outputs]
            assert set(await place.write(where, place.packed(outputs))) == {"Good"}
            assert await place.done(grant) == "Good"
            if grant == 9:
                # The next grant may be there or not: an answer once more is not one to it.
                print(f"the answer once more: {await place.done(grant)}")
        print(f"an answer after the end: {await place.done(last)}")


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
