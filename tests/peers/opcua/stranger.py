"""A client with a certificate for `URI`, which says that it is `urn:a:panel`. Prints what becomes of a write.

    stranger.py URL session|plc FOLDER URI
"""

import asyncio
import sys
from pathlib import Path

from asyncua import Client, ua
from asyncua.crypto.cert_gen import setup_self_signed_certificate
from cryptography.x509.oid import ExtendedKeyUsageOID
from lockstep import Place


async def main(url, at, folder, uri):
    key, certificate = Path(folder, "key.pem"), Path(folder, "certificate.der")
    await setup_self_signed_certificate(
        key, certificate, uri, "localhost", [ExtendedKeyUsageOID.CLIENT_AUTH], {"commonName": "panel"})
    client = Client(url, timeout=120)
    client.application_uri = "urn:a:panel"
    await client.set_security_string(f"Basic256Sha256,SignAndEncrypt,{certificate},{key}")
    async with client:
        if at == "session":
            place = await Place(client, "plc").find()
            node, value = place.Start, ua.Variant(True, ua.VariantType.Boolean)
        else:
            names = await client.get_namespace_array()
            node = client.get_node(ua.NodeId("SDSP_Limit", names.index("urn:onescan:plc:variables")))
            value = ua.Variant(0, ua.VariantType.UInt32)
        statuses = await client.write_values([node], [value], raise_on_partial_error=False)
        print(statuses[0].name)


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
