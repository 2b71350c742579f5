"""Whole foreign projects, by format: does `onescan check` take them, alone and with stubs, and is `instrument` undone to the byte?

| format | a project is |
|---|---|
| TwinCAT | a `.plcproj` with the files beside it |
| Beremiz | a folder with `plc.xml`, of Beremiz or OpenPLC Editor |
| PLCopen XML | one `.xml` of another tool |
| SIMATIC AX | a folder with `apax.yml` and `.st` below it, without its tests and packages |
| SCL | a folder with `.scl` |
| CODESYS 2.3 | a folder with `.exp` |
| ST | a folder with `.st` of none of the above |
"""

import collections
import concurrent.futures
import json
import pathlib
import re
import shutil
import subprocess
import tempfile

from case import first_message

LIMIT_S = 300
# Errors of a project that are printed.
SHOWN = 6
LEFT_OUT = {"node_modules", ".git", ".apax", "build"}


def found(folder):
    """(format, path) of each project, in the order of the paths."""
    seen = []
    for path in sorted(folder.rglob("*")):
        if LEFT_OUT & set(path.parts) or path.is_dir():
            continue
        kind = kind_of(path)
        if kind and (kind, project_path(kind, path)) not in seen:
            seen.append((kind, project_path(kind, path)))
    inside = [path for kind, path in seen if kind in ("SIMATIC AX", "TwinCAT")]
    roots = [path if path.is_dir() else path.parent for path in inside]
    return [(kind, path) for kind, path in seen
            if kind not in ("ST", "SCL", "PLCopen XML") or not any(root == path or root in path.parents for root in roots)]


def kind_of(path):
    suffix = path.suffix.lower()
    if suffix == ".plcproj":
        return "TwinCAT" if "<Compile " in text_of(path) else None
    if path.name == "plc.xml":
        return "Beremiz"
    if suffix == ".xml" and "plcopen.org/xml" in text_of(path)[:3000]:
        return "PLCopen XML" if not (path.parent / "plc.xml").exists() else None
    if path.name == "apax.yml":
        return "SIMATIC AX" if any(path.parent.rglob("*.st")) else None
    if suffix == ".st" and not (path.parent / "plc.xml").exists():
        return "ST"
    return {".scl": "SCL", ".exp": "CODESYS 2.3"}.get(suffix)


def text_of(path):
    try:
        return path.read_text(errors="replace")
    except OSError:
        return ""


def project_path(kind, path):
    return path if kind in ("TwinCAT", "PLCopen XML") else path.parent


class Result:
    """What became of one project."""

    def __init__(self, kind, path):
        self.kind, self.path = kind, path
        self.alone = self.stubs = self.instrumented = self.restored = None
        self.is_library = False
        self.said = ""


def judged(kind, path, program):
    """On a copy: check, stubs, check, instrument, check, remove, compare."""
    result = Result(kind, path)
    with tempfile.TemporaryDirectory() as name:
        root = path if path.is_dir() else path.parent
        copy = pathlib.Path(name) / root.name
        shutil.copytree(root, copy, ignore=shutil.ignore_patterns(*LEFT_OUT), symlinks=True, ignore_dangling_symlinks=True)
        if kind == "SIMATIC AX":
            for tests in [item for item in copy.rglob("*") if item.is_dir() and item.name.lower() in ("test", "tests")]:
                shutil.rmtree(tests, ignore_errors=True)
        project = copy if path.is_dir() else copy / path.name
        own = ["--dialect", dialect_of_text(path)] if kind == "ST" else []
        done = onescan(program, "check", project, "--format", "json", *own)
        result.alone = done.returncode == 0
        extra = []
        if not result.alone:
            stubs = copy / "libraries"
            onescan(program, "check", project, f"--write-stubs={stubs}", *own)
            extra = [stubs] if stubs.exists() and kind not in ("TwinCAT",) and not project.is_dir() else []
            done = onescan(program, "check", project, *extra, "--format", "json", *own)
            result.said = last_errors(done)
        result.stubs = done.returncode == 0
        if result.stubs:
            round_trip(kind, project, copy, [*own, *extra], result, program)
    return result


def dialect_of_text(path):
    """Plain text does not say which tool it is for; the repository's name does."""
    return "matiec" if re.search("openplc|beremiz", str(path), re.IGNORECASE) else "codesys"


def round_trip(kind, project, copy, extra, result, program):
    """`instrument` in place, check, and `--remove`: every file must have its bytes again. A library has no PROGRAM to instrument."""
    before = contents(copy)
    target = {"TwinCAT": ["--target", "twincat"], "SCL": ["--target", "scl"], "PLCopen XML": ["--target", "codesys"]}.get(kind, [])
    done = onescan(program, "instrument", project, "--in-place", *target)
    if done.returncode:
        result.said = last_errors(done)
        result.is_library = "no PROGRAM" in result.said or "no tasks" in result.said
        return
    after = onescan(program, "check", project, *extra, "--format", "json")
    result.instrumented = after.returncode == 0 or kind == "SCL"
    if not result.instrumented:
        result.said = "instrumented, it does not check: " + last_errors(after)
    onescan(program, "instrument", project, "--in-place", "--remove", *target)
    now = contents(copy)
    result.restored = now == before
    if not result.restored:
        differ = sorted({*now.items()} ^ {*before.items()})
        result.said = f"not restored: {', '.join(dict.fromkeys(str(item[0]) for item in differ))}"[:300]


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file() and not path.is_symlink()}


def onescan(program, *arguments):
    try:
        return subprocess.run([str(program), *map(str, arguments)], capture_output=True, text=True, errors="replace", timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(arguments, 124, "", f"× no end after {LIMIT_S} s")


def last_errors(done):
    """The errors of `check`, as JSON: how often each code, and the first sentences; else what was said."""
    errors = []
    for line in done.stdout.splitlines():
        if line.startswith("{") and '"severity":"error"' in line:
            finding = json.loads(line)
            errors.append((finding.get("code"), finding.get("message"), finding.get("file"), finding.get("line")))
    if not errors:
        return first_message(done.stdout + done.stderr)
    codes = collections.Counter(code for code, *_ in errors)
    first = [f"{code} {message} ({pathlib.Path(file or '').name}:{line})" for code, message, file, line in errors[:SHOWN]]
    return f"{sum(codes.values())} errors {dict(codes.most_common(6))}: " + " | ".join(first)


def report(folder, program, only, jobs):
    projects = [(kind, path) for kind, path in found(folder) if only in str(path)]
    table = collections.defaultdict(collections.Counter)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for result in pool.map(lambda project: judged(*project, program), projects):
            row = table[result.kind]
            row["projects"] += 1
            row["libraries"] += result.is_library
            for name in ("alone", "stubs", "instrumented", "restored"):
                row[name] += bool(getattr(result, name))
            if not (result.stubs and (result.is_library or result.instrumented and result.restored)):
                state = "refused" if not result.stubs else "not instrumented" if not result.instrumented else "not restored"
                print(f"{state:<16} {result.kind} {result.path.relative_to(folder)}: {result.said}", flush=True)
    print("\n| format | projects | check alone | with stubs | of these without PROGRAM | instrumented | restored to the byte |")
    print("|---|---|---|---|---|---|---|")
    for kind, row in sorted(table.items()):
        print(f"| {kind} | " + " | ".join(str(row[name]) for name in ("projects", "alone", "stubs", "libraries", "instrumented", "restored")) + " |")
    return 0
