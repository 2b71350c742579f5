"""Somebody with a token, its name as user and the token as password, in a session over OPC UA. Prints what becomes of
reading, of a method and of a write.

    holder.py URL NAME TOKEN
"""

import asyncio
import sys

from asyncua import Client, ua
from lockstep import Place


async def main(url, name, token):
    client = Client(url, timeout=120)
    client.set_user(name)
    client.set_password(token)
    try:
        async with client:
            place = await Place(client, "plc").find()
            members = {(await node.read_browse_name()).Name: node for node in await place.session.get_children()}
            print("read", await members["TimeStep"].read_value())
            try:
                await place.session.call_method(members["Pause"])
                print("Pause Good")
            except ua.UaStatusCodeError as error:
                print("Pause", type(error).__name__)
            print("Start", *await place.write([place.Start], [ua.Variant(True, ua.VariantType.Boolean)]))
    except ua.UaStatusCodeError as error:
        print("sent away", type(error).__name__)


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
