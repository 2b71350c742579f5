"""STruC++'s validation: pairs `NAME.st` and `test_NAME.st` below `tests/st-validation`, and its example of a traffic light.

Its tests are ST with `TEST 'name' … END_TEST`, `ASSERT_EQ`, `ASSERT_NEAR` and `ADVANCE_TIME`, and call PROGRAMs as if they
were function blocks. Each becomes a test program of `onescan test`: PROGRAM becomes FUNCTION_BLOCK whose variables are
inputs, and what follows an `ADVANCE_TIME` waits so many scans of 1 ms.
"""

import json
import pathlib
import re
import subprocess
import tempfile

import iec_text
from case import UNITS, Case, Outcome, first_message
from lit import closing, split

PAIRS = "tests/st-validation"
EXAMPLE = "tests/fixtures/smart-traffic-light"
ASSERTS = {"ASSERT_EQ": "({0}) = ({1})", "ASSERT_NEQ": "({0}) <> ({1})", "ASSERT_TRUE": "({0}) = TRUE", "ASSERT_FALSE": "({0}) = FALSE",
           "ASSERT_GT": "({0}) > ({1})", "ASSERT_LT": "({0}) < ({1})", "ASSERT_GE": "({0}) >= ({1})", "ASSERT_LE": "({0}) <= ({1})",
           "ASSERT_NEAR": "ABS(({0}) - ({1})) <= ({2})"}


def cases(folder):
    """Every TEST of the suite, with the source beside it."""
    for path in sorted((folder / PAIRS).rglob("test_*.st")):
        source = path.with_name(path.name.removeprefix("test_")).read_text()
        yield from tests(path.stem.removeprefix("test_"), source, path.read_text())
    sources = "\n".join(path.read_text() for path in sorted((folder / EXAMPLE / "src").rglob("*.st")))
    for path in sorted((folder / EXAMPLE / "tests").glob("*.st")):
        yield from tests(f"traffic_light/{path.stem}", sources, path.read_text())


def tests(prefix, source, text):
    plain = iec_text.without_comments(text)
    for found in re.finditer(r"\bTEST\s+'((?:[^'$]|\$.|'')*)'(.*?)\bEND_TEST\b", plain, re.DOTALL):
        name = f"{prefix}::{found[1]}"
        if re.search(r"\b(MOCK|MOCK_FUNCTION|MOCK_VERIFY_\w+|SETUP|TEARDOWN)\b", plain):
            yield Case(name, unreadable="it puts mocks into the program, or has SETUP")
            continue
        declared, body = re.fullmatch(r"(\s*(?:VAR\b.*?END_VAR\s*)*)(.*)", found[2], re.DOTALL).groups()
        yield Case(name, opened(source) + block(declared, body), "codesys")


def opened(source):
    """PROGRAMs that can be declared, and whose variables can be read and written."""
    def open_program(found):
        inner = re.sub(r"\bVAR\b(?!_)(?!\s+CONSTANT)", "VAR_INPUT", found[2], flags=re.IGNORECASE)
        return f"FUNCTION_BLOCK {found[1]}{inner}END_FUNCTION_BLOCK"
    source = iec_text.without_comments(source)
    source = re.sub(r"\bCONFIGURATION\b.*?\bEND_CONFIGURATION\b", "", source, flags=re.DOTALL | re.IGNORECASE)
    return re.sub(r"\bPROGRAM\s+(\w+)(.*?)\bEND_PROGRAM\b", open_program, source, flags=re.DOTALL | re.IGNORECASE)


def block(declared, body):
    """The test as phases; each begins so many scans after the one before."""
    phases = [""]
    waits = []
    at = 0
    for found in re.finditer(r"\b(ASSERT_\w+|ADVANCE_TIME)\s*\(", body):
        end = closing(body, found.end() - 1)
        phases[-1] += body[at:found.start()]
        arguments = split(body[found.end():end])
        if found[1] == "ADVANCE_TIME":
            waits.append(milliseconds(arguments[0]))
            phases.append("")
            end += 1
        else:
            condition = ASSERTS[found[1]].format(*arguments)
            phases[-1] += f"ASSERT({condition}, '{found[1].lower()} {len(phases)}')"
        at = end + 1
    phases[-1] += body[at:]
    text = "".join(f"IF harnessScan = {sum(waits[:index])} THEN\n{phase}\nEND_IF;\n" for index, phase in enumerate(phases))
    return (f"\nFUNCTION_BLOCK TEST_harness\nVAR_OUTPUT Done : BOOL; END_VAR\nVAR harnessScan : DINT; END_VAR\n{declared}\n{text}"
            f"Done := harnessScan >= {sum(waits)};\nharnessScan := harnessScan + 1;\nEND_FUNCTION_BLOCK\n")


def milliseconds(literal):
    parts = re.findall(r"([\d.]+)(ms|us|ns|d|h|m|s)", literal.partition("#")[2].lower())
    return round(sum(float(count) * UNITS[unit] for count, unit in parts))


def run(case, program):
    """One call of `onescan test`."""
    if case.unreadable:
        return Outcome("unreadable", case.unreadable)
    with tempfile.TemporaryDirectory() as name:
        path = pathlib.Path(name) / "suite.st"
        path.write_text(case.source)
        command = [str(program), "test", str(path), "--dialect", case.dialect, "--scan", "1ms", "--format", "json"]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=120)
    if done.returncode == 0:
        return Outcome("equal")
    if done.returncode == 1:
        return Outcome("other values", failures(done.stdout))
    return Outcome("refused", first_message(reported(done.stdout) + done.stderr))


def reported(text):
    """What was said of the source, out of the JSON."""
    lines = [json.loads(line) for line in text.splitlines() if line.startswith("{")]
    return "\n".join(str(line.get("error") or line.get("message") or "") for line in lines)


def failures(text):
    """The asserts that failed, by name and phase."""
    lines = [json.loads(line) for line in text.splitlines() if line.startswith("{")]
    asserts = [failed["text"] for line in lines for failed in line.get("asserts", [])]
    return ", ".join(asserts) or text[-300:]
