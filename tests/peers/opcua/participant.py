"""The shear's plant or its PLC as an OPC UA client of a session.

    participant.py URL plant|plc poll|subscribe|call
"""

import asyncio
import sys
from pathlib import Path

from lockstep import Place, by_method, by_variables, connected

PEERS = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(PEERS / "plc"), str(PEERS.parent.parent / "clients/python/src"),
                str(PEERS.parent.parent / "clients/python/examples")]


def plant():
    import importlib.util

    path = PEERS.parent.parent / "clients/python/examples/shear.py"
    spec = importlib.util.spec_from_file_location("plant", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    it = module.Shear("plant", 10_000_000)
    it.dt_s = 0.01
    return it


class Plc:
    """The shear's programs, a scan a turn."""

    def setup(self):
        from shear import Shear

        self.programs = Shear()
        return self.outputs()

    def turn(self, t_v_ns, inputs):
        from shear import INPUTS

        # Each program has the signals as variables of its own.
        self.programs.scan(t_v_ns, {path: inputs[path.split(".")[1]] for path in INPUTS})
        return self.outputs()

    def outputs(self):
        return {path.split(".")[1]: value for path, value in self.programs.out.items()}


async def main(url, name, how):
    who = plant() if name == "plant" else Plc()
    async with connected(url) as client:
        place = await Place(client, name).find()
        if how == "call":
            await by_method(place, who)
        else:
            await by_variables(place, who, subscribed=how == "subscribe")
        print(await place.end.read_value())


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
