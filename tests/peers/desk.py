"""An operator's desk on another machine: the page of a session under TLS, by Python's standard library alone.

`python3 desk.py HOST PORT CA TOKEN` checks the certificate by CA, reads the session, sits down at its live connection
(RFC 6455), waits for a status, and stops the session.
"""

import http.client
import json
import os
import ssl
import struct
import sys
from base64 import b64encode
from hashlib import sha1

GUID = "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
TEXT = 1


def frame(payload: bytes) -> bytes:
    """A text from a client: masked, shorter than 126 bytes."""
    mask = os.urandom(4)
    masked = bytes(byte ^ mask[index % 4] for index, byte in enumerate(payload))
    return bytes([0x80 | TEXT, 0x80 | len(payload)]) + mask + masked


def read(stream) -> tuple[int, bytes]:
    """The next message of the server, which does not cut them: what it is, and its payload."""
    head, length = stream.read(2)
    if length == 126:
        (length,) = struct.unpack(">H", stream.read(2))
    elif length == 127:
        (length,) = struct.unpack(">Q", stream.read(8))
    return head & 0x0F, stream.read(length)


def trusts_nobody_else(host: str, port: int) -> None:
    try:
        http.client.HTTPSConnection(host, port, context=ssl.create_default_context(), timeout=30).request("GET", "/")
    except ssl.SSLCertVerificationError as refused:
        print("without the CA:", refused.verify_message)
    else:
        raise SystemExit("a certificate of nobody was trusted")


def main() -> None:
    host, port, ca, token = sys.argv[1], int(sys.argv[2]), sys.argv[3], sys.argv[4]
    trusts_nobody_else(host, port)
    context = ssl.create_default_context(cafile=ca)
    desk = http.client.HTTPSConnection(host, port, context=context, timeout=30)
    desk.request("GET", "/api/session")
    stranger = desk.getresponse()
    stranger.read()
    print("without a token:", stranger.status)
    desk.request("GET", "/api/session", headers={"Authorization": f"Bearer {token}"})
    session = json.load(desk.getresponse())
    print("session:", session["scenario"], desk.sock.version())

    key = b64encode(os.urandom(16)).decode()
    headers = {
        "Authorization": f"Bearer {token}",
        "Origin": f"https://{host}:{port}",
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": key,
    }
    desk.request("GET", "/api/live", headers=headers)
    stream = desk.sock.makefile("rb")
    status = stream.readline().decode().strip()
    answer = dict(line.split(": ", 1) for line in iter(lambda: stream.readline().decode().strip(), ""))
    accepted = b64encode(sha1((key + GUID).encode()).digest()).decode()
    answer = {name.lower(): value for name, value in answer.items()}
    print("live:", status, answer["sec-websocket-accept"] == accepted)
    while True:
        kind, payload = read(stream)
        if kind == TEXT and json.loads(payload)["type"] == "status":
            break
    desk.sock.sendall(frame(json.dumps({"type": "operate", "operation": "stop"}).encode()))
    while stream.read(4096):
        pass
    print("the session has closed the line")


main()
