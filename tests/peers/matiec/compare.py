"""Compiles the programs of a folder with MatIEC (`iec2c`) and a C compiler, runs them, and compares every value.

    compare.py FOLDER LIBRARY

FOLDER has `prelude.st`, and for each program NAME.st and NAME.trace, as the test `matiec` of plc-shim writes them:

    >in_int:INT;int0:INT;~f0:LREAL      an input, an output, and one that is compared to a unit in the last place
    0005;0007;3fe0000000000000          a scan: the digits of each value's bytes, most significant first
    fault:DivisionByZero                 the PLC stopped; the peer ends there, too

Prints one count a line, `typed values 4000`, and one line for each program that differs, with the first value that does:
`difference typed_8: scan 3 int0:INT 0007 0008`, ours and then theirs. LIBRARY is the `lib` of MatIEC.
"""

import collections
import math
import pathlib
import re
import shutil
import struct
import subprocess
import sys

# Signed overflow is undefined in C, and wraps here.
COMPILE = ["gcc", "-O0", "-fwrapv", "-w", "-I.", "-o", "scan"]
SIZES = {"BOOL": 1, "SINT": 1, "USINT": 1, "BYTE": 1, "INT": 2, "UINT": 2, "WORD": 2, "DINT": 4, "UDINT": 4,
         "DWORD": 4, "REAL": 4, "LINT": 8, "ULINT": 8, "LWORD": 8, "LREAL": 8}


KINDS = {"STRING": "TEXT"} | dict.fromkeys(["TIME", "DATE", "TOD", "DT"], "DURATION")


class Program:
    """A program and the soft PLC's trace of it."""

    def __init__(self, path):
        self.name = path.stem
        self.family = self.name.split("_")[0]
        self.source = path.read_text()
        self.rows = path.with_suffix(".trace").read_text().split("\n")[:-1]
        self.head = self.rows.pop(0)
        self.columns = [cell.split(":") for cell in self.head.split(";")]
        self.inputs = [cell for cell in self.columns if cell[0].startswith(">")]
        self.outputs = self.columns[len(self.inputs):]
        self.steps = re.findall(r"^(?:INITIAL_)?STEP (\w+):", self.source, re.MULTILINE)
        self.lows = {}
        for name, ends in re.findall(r"(\w+) : ARRAY \[([^\]]+)\]", self.source):
            self.lows[name.upper()] = [int(end.split("..")[0]) for end in ends.split(",")]

    def place(self, path):
        """The C expression of a variable's value."""
        path = path.lstrip(">~").upper()
        whole, *parts = path.split(".")
        steps = [step.upper() for step in self.steps]
        if whole in steps:
            return f"__step_list[{steps.index(whole)}].{parts[0]}.value"
        element = re.fullmatch(r"(\w+)\[([-\d,]+)\]", whole)
        if element:
            name, indices = element.groups()
            places = zip(indices.split(","), self.lows[name])
            return f"{name}.value.table" + "".join(f"[{int(index) - low}]" for index, low in places)
        if parts and re.search(rf"\b{whole} : SPOT;", self.source, re.IGNORECASE):
            return f"{whole}.value.{parts[0]}"
        return f"{path}.value"

    def table(self):
        """Its rows of `table.h`."""
        def places(cells):
            for path, kind in cells:
                at = f"&RES__I_{self.name.upper()}.{self.place(path)}"
                yield f"    {{{at}, {KINDS.get(kind, 'NUMBER')}, {SIZES.get(kind, 0)}}},\n"
        name = self.name
        return (f"extern {name.upper()} RES__I_{name.upper()};\n"
                f"static const struct place in_{name}[] = {{\n{''.join(places(self.inputs))}}};\n"
                f"static const struct place out_{name}[] = {{\n{''.join(places(self.outputs))}}};\n")

    def row(self):
        name, upper = self.name, self.name.upper()
        return (f'    {{"{name}", (void (*)(void *)){upper}_body__, &RES__I_{upper}, '
                f"in_{name}, {len(self.inputs)}, out_{name}, {len(self.outputs)}}},\n")


def translate(folder, library, programs):
    """None, or what `iec2c` says against it."""
    instances = "".join(f"PROGRAM i_{each.name} WITH Cycle : {each.name};\n" for each in programs)
    source = ((folder / "prelude.st").read_text() + "".join(each.source for each in programs)
              + "CONFIGURATION Conf\nRESOURCE Res ON PLC\nTASK Cycle(INTERVAL := T#10ms, PRIORITY := 0);\n"
              + instances + "END_RESOURCE\nEND_CONFIGURATION\n")
    (folder / "batch.st").write_text(source)
    command = ["iec2c", "-f", "-l", "-p", "-I", str(library), "-T", ".", "batch.st"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    return None if done.returncode == 0 and "error" not in done.stderr else done.stderr.strip() or f"exit {done.returncode}"


def build(folder, library, programs):
    (folder / "table.h").write_text("".join(each.table() for each in programs)
                                    + "static const struct program programs[] = {\n"
                                    + "".join(each.row() for each in programs) + "};\n")
    harness = pathlib.Path(__file__).with_name("scan.c")
    units = [str(harness), "Conf.c", "Res.c"]
    done = subprocess.run([*COMPILE, "-I", str(library / "C"), *units, "-lm"], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{folder}: {done.stderr}")


def real(digits):
    return struct.unpack(">f" if len(digits) == 8 else ">d", bytes.fromhex(digits))[0]


def verdict(path, kind, ours, theirs):
    """How two values compare: equal, except for the sign of zero, rounded or different."""
    if ours == theirs:
        return "equal"
    if kind in ("REAL", "LREAL"):
        a, b = real(ours), real(theirs)
        if math.isnan(a) and math.isnan(b):
            return "equal"
        if a == b:  # ABS(-0.0) is 0.0 here and -0.0 there
            return "equal except for the sign of zero"
        if path.startswith("~") and math.isclose(a, b, rel_tol=0, abs_tol=math.ulp(max(abs(a), abs(b)))):
            return "rounded otherwise"
    return "different"


def compare(program, folder, counts):
    """The first difference, or None."""
    program.counted = collections.Counter()
    try:
        return first_difference(program, folder, program.counted)
    finally:
        counts.update(program.counted)


def first_difference(program, folder, counts):
    family = program.family
    peer = folder / f"{program.name}.peer"
    theirs = peer.read_text().split("\n")[1:-1] if peer.exists() else []
    ours = [row for row in program.rows if not row.startswith("fault")]
    counts[f"{family} programs"] += 1
    counts[f"{family} stopped by a fault"] += len(program.rows) - len(ours)
    if len(theirs) != len(ours):
        return f"the peer made {len(theirs)} scans of {len(ours)}"
    for scan, (row, other) in enumerate(zip(ours, theirs)):
        counts[f"{family} scans"] += 1
        counts[f"{family} values"] += len(program.outputs)
        if row == other:
            counts[f"{family} equal"] += len(program.outputs)
            continue
        for (path, kind), a, b in zip(program.columns, row.split(";"), other.split(";")):
            found = verdict(path, kind, a, b)
            if found == "different":
                return f"scan {scan + 1} {path}:{kind} {a} {b}"
            if not path.startswith(">"):
                counts[f"{family} {found}"] += 1
    return None


def corrected(library, folder):
    """The library with the one fault of it that no choice of programs avoids: 1000000000 ns are not carried to a second,
    so that T#990ms + T#10ms is less than T#1s."""
    copy = folder / "corrected"
    shutil.copytree(library, copy, dirs_exist_ok=True)
    header = copy / "C" / "iec_std_lib.h"
    text = header.read_text(errors="surrogateescape")
    for fault, right in (("tv_nsec < -1000000000 ", "tv_nsec <= -1000000000 "), ("tv_nsec > 1000000000 ", "tv_nsec >= 1000000000 ")):
        text = text.replace(fault, right)
    header.write_text(text, errors="surrogateescape")
    return copy


def run(folder, library, programs):
    """Runs programs; by name, what the system says of those that crash or do not end."""
    build(folder, library, programs)
    said = subprocess.run(["./scan"], cwd=folder, capture_output=True, text=True, check=True).stdout
    return dict(line.split(" ", 1) for line in said.splitlines())


def judge(folder, library, programs, counts):
    """Those that differ, with their first difference."""
    died = run(folder, library, programs)
    found = {each: compare(each, folder, counts) for each in programs}
    return {each: f"{what} {died.get(each.name, '')}".rstrip() for each, what in found.items() if what}


def main():
    folder, library = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    programs = [Program(path) for path in sorted(folder.glob("*_*.st"))]
    counts = collections.Counter()
    if translate(folder, library, programs):
        # One of them is refused, and with it all.
        accepted = []
        for each in programs:
            refused = translate(folder, library, [each])
            if refused:
                print(f"difference {each.name}: refused: {refused.splitlines()[0]}")
                counts[f"{each.family} refused"] += 1
            else:
                accepted.append(each)
        programs = accepted
        refused = translate(folder, library, programs)
        if refused:
            raise SystemExit(f"{folder}: {refused}")
    differing = judge(folder, library, programs, counts)
    again = [each for each in differing if each.family != "known"]
    if again:
        for each in again:
            counts.subtract(each.counted)
        translate(folder, library, again)
        still = judge(folder, corrected(library, folder), again, counts)
        for each in again:
            if each not in still:
                del differing[each]
                counts[f"{each.family} programs equal once seconds are carried"] += 1
    for each, what in differing.items():
        print(f"difference {each.name}: {what}")
        counts[f"{each.family} programs that differ"] += 1
    for what, count in sorted(counts.items()):
        print(f"{what} {count}")


if __name__ == "__main__":
    main()
