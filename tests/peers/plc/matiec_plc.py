"""A PLC made of what MatIEC and a C compiler make of `sdsp.st`, with OpenPLC's places of Modbus.

    matiec_plc.py FOLDER IEC2C LIBRARY

Compiles FOLDER/sdsp.st as OpenPLC does, prints the port of its Modbus server, and scans between requests until it is ended. Between two
requests it scans once, as a PLC does whose cycle is as long as an exchange. Only the standard library is used.
"""

import ctypes
import pathlib
import re
import select
import socket
import struct
import subprocess
import sys

GLUE = """
#include "iec_std_lib.h"
#define __LOCATED_VAR(type, name, ...) type __##name; type *name = &__##name;
#include "LOCATED_VARIABLES.h"
#undef __LOCATED_VAR
TIME __CURRENT_TIME; BOOL __DEBUG = 0;
extern unsigned long long common_ticktime__;
void config_init__(void);
void config_run__(unsigned long tick);
static unsigned long tick;
void plc_begin(void) { config_init__(); }
void plc_scan(void) {
    config_run__(tick++);
    __CURRENT_TIME.tv_nsec += common_ticktime__;
    __CURRENT_TIME.tv_sec += __CURRENT_TIME.tv_nsec / 1000000000;
    __CURRENT_TIME.tv_nsec %= 1000000000;
}
"""
# Where the words of a size begin among the holding registers, and how many registers each has.
WORDS = {"W": (1024, 1), "D": (2048, 2), "L": (4096, 4)}
BYTES = {"X": 1, "W": 2, "D": 4, "L": 8}


def compiled(folder, iec2c, library):
    subprocess.run([iec2c, "-f", "-l", "-p", "-r", "-R", "-a", "-I", library, "sdsp.st"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    (folder / "glue.c").write_text(GLUE)
    sources = ["glue.c", *sorted(path.name for path in folder.glob("Config*.c")), *sorted(path.name for path in folder.glob("Res*.c"))]
    subprocess.run(["gcc", "-shared", "-fPIC", "-O1", "-fwrapv", "-w", f"-I{library}/C", "-I.", "-o", "plc.so", *sources], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / "plc.so"))


class Memory:
    """The located variables, by OpenPLC's numbers of coils and registers."""

    def __init__(self, plc, folder):
        self.coils, self.registers = {}, {}
        for name, size, place, bit in re.findall(r"__LOCATED_VAR\(\w+,(__[QM]([XWDL])(\d+)(?:_(\d+))?),", (folder / "LOCATED_VARIABLES.h").read_text()):
            variable = (ctypes.c_uint8 * BYTES[size]).in_dll(plc, f"__{name}")
            if size == "X":
                self.coils[8 * int(place) + int(bit)] = variable
                continue
            base, count = WORDS[size]
            for word in range(count):
                # The high word comes first, and within the processor's memory the low byte does.
                self.registers[base + count * int(place) + word] = (variable, 2 * (count - 1 - word))

    def answer(self, request):
        """The answer to a request, without its header."""
        function, at, value = struct.unpack(">BHH", request[:5])
        match function:
            case 1:
                bits = [self.coils[at + n][0] & 1 if at + n in self.coils else 0 for n in range(value)]
                packed = bytes(sum(bit << n for n, bit in enumerate(bits[i:i + 8])) for i in range(0, value, 8))
                return bytes([1, len(packed)]) + packed
            case 3:
                return bytes([3, 2 * value]) + b"".join(self.register(at + n) for n in range(value))
            case 5:
                self.set_coil(at, value != 0)
            case 6:
                self.set_register(at, request[3:5])
            case 15:
                for n in range(value):
                    self.set_coil(at + n, request[6 + n // 8] >> n % 8 & 1)
            case 16:
                for n in range(value):
                    self.set_register(at + n, request[6 + 2 * n:8 + 2 * n])
            case _:
                return bytes([function | 0x80, 1])
        return request[:5]

    def register(self, at):
        if at not in self.registers:
            return b"\0\0"
        variable, low = self.registers[at]
        return bytes([variable[low + 1], variable[low]])

    def set_register(self, at, word):
        if at in self.registers:
            variable, low = self.registers[at]
            variable[low + 1], variable[low] = word

    def set_coil(self, at, is_on):
        if at in self.coils:
            self.coils[at][0] = 1 if is_on else 0


def exactly(connection, count):
    got = b""
    while len(got) < count:
        more = connection.recv(count - len(got))
        if not more:
            raise EOFError
        got += more
    return got


def serve(plc, memory, listener):
    connection, _ = listener.accept()
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    while True:
        plc.plc_scan()
        while select.select([connection], [], [], 0.0005)[0]:
            head = exactly(connection, 7)
            request = exactly(connection, struct.unpack(">H", head[4:6])[0] - 1)
            answer = memory.answer(request)
            connection.sendall(head[:4] + struct.pack(">H", len(answer) + 1) + head[6:] + answer)


def main():
    folder, iec2c, library = (pathlib.Path(word).resolve() for word in sys.argv[1:])
    plc = compiled(folder, iec2c, library)
    memory = Memory(plc, folder)
    plc.plc_begin()
    with socket.create_server(("127.0.0.1", 0)) as listener:
        print(listener.getsockname()[1], flush=True)
        while True:
            try:
                serve(plc, memory, listener)
            except (EOFError, ConnectionError):
                continue


main()
