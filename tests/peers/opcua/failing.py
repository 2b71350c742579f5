"""A PLC of the shear that fails after 20 steps: it dies without a word, leaves, hangs, or says why it
cannot go on.

    failing.py URL dies|leaves|hangs|fault
"""

import asyncio
import os
import sys

from asyncua import ua
from participant import Plc

from lockstep import ENDED, Place, by_variables, connected


class Failing(Plc):
    def __init__(self, fail):
        self.fail = fail

    def turn(self, t_v_ns, inputs):
        if t_v_ns >= 200_000_000:
            self.fail()
        return super().turn(t_v_ns, inputs)


class Over(Exception):
    pass


def over():
    raise Over


async def main(url, how):
    async with connected(url) as client:
        place = await Place(client, "plc").find()
        try:
            await by_variables(place, Failing((lambda: os._exit(1)) if how == "dies" else over))
        except Over:
            if how == "fault":
                await place.write([place.Fault], [ua.Variant("the valve is stuck", ua.VariantType.String)])
            if how in ("fault", "hangs"):
                while await place.State.read_value() != ENDED:
                    pass


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
