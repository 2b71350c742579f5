"""What a program needs of the system that runs it, read from its file."""

import struct
from dataclasses import dataclass
from pathlib import Path

MACHINES = {62: "x86_64", 183: "aarch64"}
# What every Linux with glibc has, by the rules of manylinux.
COMMON = {"libc.so.6", "libm.so.6", "libgcc_s.so.1", "libpthread.so.0", "libdl.so.2", "librt.so.1",
          "ld-linux-x86-64.so.2", "ld-linux-aarch64.so.1"}
# Rust's standard library asks for it, and the tags of manylinux begin there.
GLIBC_MIN = 17


class NotAProgram(Exception):
    """The file is not a program that can be packed."""


@dataclass(frozen=True)
class Needs:
    """Where a program runs."""

    system: str
    machine: str
    # Of 2.x; none where the program brings its C library with it.
    glibc: int | None

    @property
    def is_static(self) -> bool:
        return self.system == "linux" and self.glibc is None

    @property
    def wheel_tag(self) -> str:
        """The platform in the name of a wheel."""
        if self.system == "windows":
            return "win_amd64"
        if self.glibc is None:
            return f"manylinux_2_{GLIBC_MIN}_{self.machine}.musllinux_1_1_{self.machine}"
        return f"manylinux_2_{self.glibc}_{self.machine}"


def needs(path: Path) -> Needs:
    """Reads the program's file."""
    data = path.read_bytes()
    if data[:2] == b"MZ":
        return Needs("windows", "x86_64", None)
    if data[:4] != b"\x7fELF" or data[4] != 2 or data[5] != 1:
        raise NotAProgram(f"{path} is not a 64-bit program of Linux or Windows")
    machine = MACHINES.get(struct.unpack_from("<H", data, 18)[0])
    if machine is None:
        raise NotAProgram(f"{path} is for a machine that is not packed")
    libraries, versions = _linked(data)
    other = libraries - COMMON
    if other:
        raise NotAProgram(f"{path} needs {', '.join(sorted(other))}, which not every Linux has")
    if not libraries:
        return Needs("linux", machine, None)
    numbers = [int(name.split(".")[1]) for name in versions if name.startswith("GLIBC_2.")]
    return Needs("linux", machine, max([GLIBC_MIN, *numbers]))


def _linked(data: bytes) -> tuple[set[str], set[str]]:
    """The libraries that the program names, and the versions of their symbols."""
    offset, = struct.unpack_from("<Q", data, 40)
    size, count = struct.unpack_from("<HH", data, 58)
    sections = [struct.unpack_from("<IIQQQQIIQQ", data, offset + size * at) for at in range(count)]
    libraries, versions = set(), set()
    for section in sections:
        kind, start, length, link = section[1], section[4], section[5], section[6]
        if kind == 6:  # what is linked when it starts
            for at in range(start, start + length, 16):
                tag, value = struct.unpack_from("<QQ", data, at)
                if tag == 1:
                    libraries.add(_text(data, sections[link][4] + value))
        elif kind == 0x6FFFFFFE:  # versions that are needed
            versions |= _versions(data, start, sections[link][4])
    return libraries, versions


def _versions(data: bytes, start: int, texts: int) -> set[str]:
    found = set()
    library = start
    while True:
        _, count, _, first, following = struct.unpack_from("<HHIII", data, library)
        entry = library + first
        for _ in range(count):
            _, _, _, name, after = struct.unpack_from("<IHHII", data, entry)
            found.add(_text(data, texts + name))
            entry += after
        if following == 0:
            return found
        library += following


def _text(data: bytes, at: int) -> str:
    return data[at:data.index(b"\0", at)].decode()
