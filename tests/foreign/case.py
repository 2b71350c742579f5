"""A case of a foreign suite: a program, what is written into it and when, and the values that its authors want."""

import dataclasses
import datetime
import json
import pathlib
import re
import subprocess
import tempfile

SCAN_MS = 10


@dataclasses.dataclass
class Write:
    """A value that a variable gets once, before scan `scan` (the first is 1)."""
    scan: int
    path: str
    value: str


@dataclasses.dataclass
class Expected:
    """What a variable must be after scan `scan`."""
    path: str
    value: object
    tolerance: float = 0.0
    scan: int = 1


@dataclasses.dataclass
class Case:
    """One test of the suite. `unreadable` says why the harness cannot turn it into a run."""
    name: str
    source: str = ""
    dialect: str = "iec3"
    program: str = "main"
    expected: list = dataclasses.field(default_factory=list)
    writes: list = dataclasses.field(default_factory=list)
    scans: int = 1
    interval_ms: int = SCAN_MS
    # Names of an enumeration's values, in the order of the declaration: a suite may want numbers.
    ordinals: dict = dataclasses.field(default_factory=dict)
    # Numbers that the suite has for a ms of TIME, and for a s of DATE and DT: machines keep times differently.
    per_ms: float = 1
    per_s: float = 1
    # The suite wants the program refused, or stopped by a fault.
    refused: bool = False
    unreadable: str = ""


@dataclasses.dataclass
class Outcome:
    """`kind` is one of KINDS; `text` is what to read when it is not `equal`."""
    kind: str
    text: str = ""


KINDS = ["equal", "other values", "refused", "stopped", "taken", "unreadable"]


def run(case, program, compare=None):
    """Runs a case and compares; `compare` says what of the watched values to look at, if not those that are expected."""
    if case.unreadable:
        return Outcome("unreadable", case.unreadable)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_scenario(case, folder)
        paths = dict.fromkeys(expected.path for expected in case.expected)
        command = [str(program), "run", ".", "--format", "json", "--watch-on", "change"]
        command += ["--case", "case"] if case.writes else []
        for path in paths:
            command += ["--watch", path]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=120)
    said = first_message(done.stdout + done.stderr)
    if case.refused:
        return Outcome("equal") if done.returncode else Outcome("taken", "the suite wants this refused")
    if done.returncode:
        return Outcome("stopped" if "fault" in said.lower() else "refused", said)
    return (compare or compared)(case, changes(done.stdout))


def write_scenario(case, folder):
    """The program as a soft PLC of its own scenario, without a plant."""
    interval = f"{case.interval_ms}ms"
    (folder / "program.st").write_text(case.source)
    (folder / "scenario.toml").write_text(
        f'version = 1\nstep = "{interval}"\nuntil = "{case.scans * case.interval_ms}ms"\n\n[signals]\n\n'
        f'[clients.plc]\nkind = "soft-plc"\nsources = ["program.st"]\ndialect = "{case.dialect}"\n'
        f'tasks = [{{ name = "task", interval = "{interval}", programs = ["{case.program}"] }}]\n')
    if case.writes:
        (folder / "cases.toml").write_text('version = 1\n\n[[case]]\nname = "case"\n' + "".join(
            f'\n[[case.variable]]\nvariable = "{write.path}"\nvalue = {json.dumps(write.value)}\n'
            f'at = "{write.scan * case.interval_ms}ms"\n' for write in case.writes))


def first_message(text):
    """The codes and sentences of the first findings, on one line."""
    plain = re.sub(r"\x1b\[[0-9;]*m", "", text)
    found = re.findall(r"^(?:Error: (\w+)|\s*×\s*(.*))$", plain, re.MULTILINE)
    words = [code or sentence for code, sentence in found if "do not compile" not in sentence]
    return " | ".join(words[:4])[:300] or plain.strip()[-300:]


def changes(text):
    """Of each watched variable, its values as (scan's end in ns, literal), in the order of time."""
    seen = {}
    for line in text.splitlines():
        if line.startswith("{"):
            for value in (json.loads(line).get("watched") or {}).get("values", []):
                seen.setdefault(value["path"], []).append((value["since_ns"], value["value"]))
    return seen


def compared(case, seen):
    """Every value that is wanted, beside what it was after that scan."""
    differences = []
    for expected in case.expected:
        end = expected.scan * case.interval_ms * 1_000_000
        values = [value for since, value in seen.get(expected.path, []) if since <= end]
        if not values:
            return Outcome("unreadable", f"{expected.path} was not watched")
        ours = number(values[-1], case)
        if not equal(ours, expected.value, expected.tolerance):
            differences.append(f"{expected.path} after scan {expected.scan}: wanted {expected.value!r}, was {values[-1]}")
    return Outcome("other values", "; ".join(differences[:4])) if differences else Outcome("equal")


def equal(ours, wanted, tolerance):
    """Numbers by tolerance, text as it is; a number wanted of a text is never equal."""
    if isinstance(ours, str) or isinstance(wanted, str):
        return ours == wanted
    if ours != ours or wanted != wanted:
        return (ours != ours) == (wanted != wanted)
    if ours in (float("inf"), float("-inf")) or wanted in (float("inf"), float("-inf")):
        return ours == wanted
    return abs(ours - wanted) <= tolerance


UNITS = {"d": 86_400_000, "h": 3_600_000, "m": 60_000, "s": 1000, "ms": 1, "us": 1e-3, "ns": 1e-6}


DAY_S = 86_400


def number(literal, case):
    """The value of a literal as onescan writes it, in the suite's units; text without quotes."""
    text = literal.strip()
    name = text.rpartition("#")[2]
    if name.upper() in case.ordinals:
        return case.ordinals[name.upper()]
    if text in ("TRUE", "FALSE"):
        return int(text == "TRUE")
    if text[:1] in "'\"":
        return unescaped(text[1:-1])
    time = re.fullmatch(r"(?:T|TIME|LT|LTIME)#(-?)(.*)", text)
    if time:
        parts = re.findall(r"([\d.]+)(ms|us|ns|d|h|m|s)", time[2])
        total = sum(float(count) * UNITS[unit] for count, unit in parts)
        return case.per_ms * (-total if time[1] else total)
    moment = re.fullmatch(r"(?:L?TOD|L?TIME_OF_DAY)#(\d+):(\d+):([\d.]+)", text)
    if moment:
        return case.per_ms * 1000 * (int(moment[1]) * 3600 + int(moment[2]) * 60 + float(moment[3]))
    date = re.fullmatch(r"(?:L?D|L?DT|L?DATE|L?DATE_AND_TIME)#(\d+)-(\d+)-(\d+)(?:-(\d+):(\d+):([\d.]+))?", text)
    if date:
        days = (datetime.date(*map(int, date.groups()[:3])) - datetime.date(1970, 1, 1)).days
        hours, minutes, seconds = (float(part or 0) for part in date.groups()[3:])
        return case.per_s * (days * DAY_S + hours * 3600 + minutes * 60 + seconds)
    based = re.fullmatch(r"(?:\w+#)?(-?)(2|8|16)#([0-9A-Fa-f_]+)", text)
    if based:
        return int(based[1] + based[3].replace("_", ""), int(based[2]))
    try:
        return float(name) if re.search(r"[.eEn]", name) else int(name)
    except ValueError:
        return text


def unescaped(text):
    """A string literal's characters."""
    names = {"N": "\n", "L": "\n", "R": "\r", "T": "\t", "P": "\f", "$": "$", "'": "'", '"': '"'}
    return re.sub(r"\$([0-9A-Fa-f]{2}|.)", lambda found: names.get(found[1].upper()) or chr(int(found[1], 16)), text)
