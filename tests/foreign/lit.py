"""RuSTy's lit tests, `tests/lit/single/**.st` of its repository: what `printf` writes, beside the lines `// CHECK: …`.

Each `printf` becomes statements that append to logs: which place it was, and its numbers and texts. The lines are put
together here from the logs, so that no formatting of onescan's takes part.
"""

import re

import iec_text
import case
from case import Case, Expected, Outcome, unescaped

TESTS = "tests/lit/single"
DIALECT = "codesys"
ENTRIES = 400
LOGS = f"""
VAR_GLOBAL
    HarnessPlaces : ARRAY[1..{ENTRIES}] OF DINT;
    HarnessCount : DINT;
    HarnessWhole : ARRAY[1..{ENTRIES}] OF LINT;
    HarnessWholes : DINT;
    HarnessReal : ARRAY[1..{ENTRIES}] OF LREAL;
    HarnessReals : DINT;
    HarnessText : ARRAY[1..{ENTRIES}] OF STRING(255);
    HarnessTexts : DINT;
END_VAR
FUNCTION HarnessPrint : BOOL VAR_INPUT place : DINT; END_VAR
HarnessCount := HarnessCount + 1;
HarnessPlaces[HarnessCount] := place;
END_FUNCTION
FUNCTION HarnessPutWhole : BOOL VAR_INPUT value : LINT; END_VAR
HarnessWholes := HarnessWholes + 1;
HarnessWhole[HarnessWholes] := value;
END_FUNCTION
FUNCTION HarnessPutReal : BOOL VAR_INPUT value : LREAL; END_VAR
HarnessReals := HarnessReals + 1;
HarnessReal[HarnessReals] := value;
END_FUNCTION
FUNCTION HarnessPutText : BOOL VAR_INPUT value : STRING(255); END_VAR
HarnessTexts := HarnessTexts + 1;
HarnessText[HarnessTexts] := value;
END_FUNCTION
PROGRAM harness
main();
END_PROGRAM
"""
PLACE = re.compile(r"%[-+ #0]*\d*(?:\.\d+)?(?:hh|h|ll|l)?([a-zA-Z%])")


def run(a_case, program):
    """As any case, but its lines are compared."""
    return case.run(a_case, program, compared)


def cases(folder):
    """Every test that prints lines which are checked in their order."""
    for path in sorted((folder / TESTS).rglob("*.st")):
        name = str(path.relative_to(folder / TESTS).with_suffix(""))
        text = path.read_text()
        if "%RUN" not in text or not re.search(r"//\s*CHECK:", text):
            yield Case(name, unreadable="it does not run, or checks what the compiler says")
        elif "__init_" in text:
            yield Case(name, unreadable="it calls what the compiler adds")
        elif re.search(r"CHECK-(?!NEXT)\w+:|\{\{|CHECK-NOT", text):
            yield Case(name, unreadable="its checks are patterns")
        else:
            yield printing(name, text)


def printing(name, text):
    lines = [line.strip() for line in re.findall(r"//\s*CHECK(?:-NEXT)?:\s?(.*)", text)]
    formats, source = [], []
    at = 0
    plain = iec_text.without_comments(text)
    for found in re.finditer(r"\bprintf\s*\(", plain):
        if found.start() < at:
            continue
        end = closing(plain, found.end() - 1)
        arguments = split(plain[found.end():end])
        if not arguments or arguments[0][:1] != "'":
            return Case(name, unreadable="a format that is not written out")
        source.append(plain[at:found.start()] + puts(len(formats), arguments))
        formats.append(arguments[0][1:-1])
        at = end + 1
    source.append(plain[at:])
    built = Case(name, "".join(source) + LOGS, DIALECT, "harness")
    built.formats, built.lines = formats, lines
    last = max(1, min(ENTRIES, 4 * len(lines) + 8))
    built.expected = [Expected(f"{log}[{index}]", None) for log in ("HarnessPlaces", "HarnessWhole", "HarnessReal", "HarnessText")
                     for index in range(1, last + 1)] + [Expected("HarnessCount", None)]
    return built


def closing(text, at):
    """The bracket that closes the one at `at`, in ST."""
    depth = 0
    while at < len(text):
        quoted = re.compile(r"'(?:[^'$]|\$.)*'|\"(?:[^\"$]|\$.)*\"").match(text, at)
        if quoted:
            at = quoted.end()
            continue
        depth += (text[at] in "([") - (text[at] in ")]")
        if depth == 0:
            return at
        at += 1
    return at


def split(text):
    """The arguments of a call in ST."""
    parts, start, at = [], 0, 0
    while at < len(text):
        quoted = re.compile(r"'(?:[^'$]|\$.)*'|\"(?:[^\"$]|\$.)*\"").match(text, at)
        if quoted:
            at = quoted.end()
        elif text[at] in "([":
            at = closing(text, at) + 1
        else:
            if text[at] == ",":
                parts.append(text[start:at].strip())
                start = at + 1
            at += 1
    return [part for part in [*parts, text[start:].strip()] if part]


def puts(place, arguments):
    """The statements that stand for one `printf`."""
    calls = []
    letters = [letter for letter in PLACE.findall(arguments[0]) if letter != "%"]
    for letter, term in zip(letters, arguments[1:]):
        if letter == "s":
            term = re.sub(r"^(?:ADR|REF)\s*\((.*)\)$", r"\1", term, flags=re.DOTALL)
            calls.append(f"HarnessPutText({term})")
        elif letter in "feEgG":
            calls.append(f"HarnessPutReal(TO_LREAL({term}))")
        else:
            calls.append(f"HarnessPutWhole(TO_LINT({term}))")
    # The arguments come first: a function that they call may print, too.
    return "; ".join([*calls, f"HarnessPrint({place})"])


def printed(a_case, seen):
    """The lines, from the logs at the end."""
    def value(path):
        return seen[path][-1][1]
    whole, real, text, out = 1, 1, 1, ""
    count = int(value("HarnessCount"))
    for entry in range(1, count + 1):
        template = unescaped(a_case.formats[int(value(f"HarnessPlaces[{entry}]"))])
        values = []
        for letter in PLACE.findall(template):
            if letter == "%":
                continue
            if letter == "s":
                values.append(unescaped(value(f"HarnessText[{text}]")[1:-1]))
                text += 1
            elif letter in "feEgG":
                values.append(float(value(f"HarnessReal[{real}]")))
                real += 1
            else:
                values.append(int(value(f"HarnessWhole[{whole}]")))
                whole += 1
        out += re.sub(r"(?<=\d)(?:hh|h|ll|l)(?=[a-z])|(?<=%)(?:hh|h|ll|l)(?=[a-z])", "", template).replace("%u", "%d") % tuple(values)
    return [" ".join(line.split()) for line in out.split("\n") if line.strip()]


def compared(a_case, seen):
    """The first line that differs."""
    ours = printed(a_case, seen)
    wanted = [" ".join(line.split()) for line in a_case.lines if line.strip()]
    for index in range(max(len(ours), len(wanted))):
        pair = [lines[index] if index < len(lines) else "(nothing)" for lines in (wanted, ours)]
        if pair[0] != pair[1]:
            return Outcome("other values", f"line {index + 1}: wanted `{pair[0]}`, was `{pair[1]}`")
    return Outcome("equal")
