"""Values and their bytes (PROTOCOL.md, section 3.2)."""
from __future__ import annotations

import functools
import re
import struct
from typing import Tuple, Union

from .errors import ProtocolError

Value = Union[bool, int, float, str]

_FORMATS = {name: code for code, names in {
    "?": "BOOL", "B": "BYTE USINT CHAR", "b": "SINT", "H": "WORD UINT WCHAR", "h": "INT", "I": "DWORD UDINT",
    "i": "DINT", "Q": "LWORD ULINT", "q": "LINT TIME LTIME DATE LDATE TOD LTOD DT LDT", "f": "REAL",
    "d": "LREAL"}.items() for name in names.split()}


@functools.lru_cache(maxsize=None)
def layout(type_name: str) -> Tuple[struct.Struct, int]:
    """The bytes of a type (their number is `.size`) and, of STRING and WSTRING, those of a character, or 0."""
    match = re.fullmatch(r"(W?)STRING\[([0-9]+)\]", type_name)
    if match:
        width = 2 if match[1] else 1
        return struct.Struct(f"<H{width * int(match[2])}s"), width
    match = re.fullmatch(r"BYTES\[([0-9]+)\]", type_name)
    if match:
        window = int(match[1])
        return struct.Struct(f"{28 + window + (window + 7) // 8}s"), 0
    if type_name not in _FORMATS:
        raise ValueError(f"{type_name!r} is no elementary type; strings have their length, as STRING[80]")
    return struct.Struct("<" + _FORMATS[type_name]), 0


def zero(type_name: str) -> Value:
    """What a variable of this type is when nobody has written it."""
    form, width = layout(type_name)
    if width:
        return ""
    if type_name.startswith("BYTES"):
        return "00" * form.size
    return {"?": False, "f": 0.0, "d": 0.0}.get(form.format[-1], 0)


def pack(type_name: str, value: Value) -> bytes:
    """The encoding of a value: bool, int, float, or str (STRING as Latin-1, WSTRING as UTF-16, a line
    of bytes in hexadecimal, see `streams`)."""
    form, width = layout(type_name)
    if width:
        if not isinstance(value, str):
            raise ValueError(f"{value!r} is no {type_name}")
        text = value.encode("latin-1") if width == 1 else value.encode("utf-16-le", "surrogatepass")
        if len(text) > form.size - 2:
            raise ValueError(f"{value!r} is too long for {type_name}")
        return form.pack(len(text) // width, text)
    if type_name.startswith("BYTES"):
        data = bytes.fromhex(value) if isinstance(value, str) else b""
        if len(data) != form.size:
            raise ValueError(f"{value!r} is no {type_name}")
        return data
    if type_name == "BOOL" and value not in (0, 1):
        raise ValueError(f"{value!r} is no BOOL")
    try:
        return form.pack(value)
    except (struct.error, OverflowError) as error:
        raise ValueError(f"{value!r} is no {type_name}: {error}") from error


def unpack(type_name: str, data: bytes) -> Value:
    """The value that `layout(type_name)[0].size` bytes encode."""
    form, width = layout(type_name)
    if width:
        used, text = form.unpack(data)
        if used * width > len(text):
            raise ProtocolError(f"{used} characters in a {type_name}")
        characters: bytes = text[:used * width]
        return characters.decode("latin-1") if width == 1 else characters.decode("utf-16-le", "surrogatepass")
    if type_name == "BOOL" and data[0] > 1:
        raise ProtocolError(f"{data[0]} is no BOOL")
    if type_name.startswith("BYTES"):
        return data.hex()
    value: Value = form.unpack(data)[0]
    return value
