"""IronPLC's end-to-end tests: `compiler/codegen/tests/it/end_to_end*.rs` of its repository.

A test compiles a program, runs one scan (or several, with values written between) and looks at the slots of its machine: slot
n is the n-th variable, globals first. Slots of strings and structures have no name there, so such tests are `unreadable`.
"""

import re

import iec_text
import rust_text
from case import Case, Expected, Write

TESTS = "compiler/codegen/tests/it"
DIALECTS = {"Codesys": "codesys", "TwinCat": "twincat"}
ALSO_CODESYS = ("allow_", "Rusty")


def cases(folder):
    """Every test of the suite."""
    for path in sorted((folder / TESTS).glob("end_to_end*.rs")):
        text = path.read_text()
        constants = {found[1]: rust_text.string(rust_text.LITERAL.match(text, found.end())[0])
                     for found in re.finditer(r"const (\w+): &str =\s*(?=r?#*\")", text)}
        short = path.stem.removeprefix("end_to_end_")
        for name, arguments, _ in rust_text.calls(text, r"e2e_\w+"):
            yield from macro(f"{short}::", name, arguments)
        for attributes, name, parameters, body in rust_text.functions(text):
            if "#[rstest" in attributes:
                for label, bound in tables(attributes, parameters):
                    yield function(f"{short}::{name}::{label}", bound | body_constants(constants), body)
            elif "#[test]" in attributes:
                yield function(f"{short}::{name}", body_constants(constants), body)


def body_constants(constants):
    return {name: repr_of(text) for name, text in constants.items() if text is not None}


def repr_of(text):
    """A Rust raw string literal of these characters."""
    return f'r####"{text}"####' if '"####' not in text else '""'


def macro(prefix, name, arguments):
    """`e2e_i32!(name, source, &[(slot, value), …])`; with options or a tolerance before the source."""
    attributes, _, test = arguments[0].rpartition("]")
    options = arguments[1] if name.endswith("_with") else ""
    tolerance = rust_text.value(arguments[1]) if name.endswith("_near") else 0.0
    source = next((text for text in map(rust_text.string, arguments[1:]) if text is not None), None)
    pairs = re.sub(r"^&\s*", "", arguments[-1]).strip()
    wanted = [(rust_text.split(pair.strip()[1:-1])) for pair in rust_text.split(pairs[1:-1])]
    steps = [("expect", int(slot), rust_text.value(value), tolerance) for slot, value in wanted]
    return [built(prefix + test.strip(), source, options, [("run", 0)] + steps)]


def tables(attributes, parameters):
    """Each `#[case::label(…)]` as values by the parameters' names."""
    names = re.findall(r"#\[case\]\s*(\w+)", parameters)
    for found in re.finditer(r"#\[case(?:::(\w+))?\(", attributes):
        inner = attributes[found.end():rust_text.closing(attributes, found.end() - 1)]
        values = rust_text.split(rust_text.without_comments(inner))
        yield found[1] or "case", dict(zip(names, values))


ENTRIES = r"parse_and_run_rounds|parse_and_run|drive_fb|parse_and_try_run|try_parse_and_compile|parse_and_compile|assert_run_\w+"


def function(name, bound, body):
    """A `#[test]` whose body compiles one source."""
    body = rust_text.without_comments(body)
    local = {found[1]: body[found.end():end_of_statement(body, found.end())]
             for found in re.finditer(r"let (\w+)(?:: [&\w]+)? =\s*", body)}
    known = bound | {key: resolve(text, bound) for key, text in local.items()}
    entry = next(rust_text.calls(body, ENTRIES), None)
    if not entry:
        return Case(name, unreadable="not a program that runs")
    what, arguments, _ = entry
    source = rust_text.string(resolve(resolve(arguments[0], known), known))
    if what == "try_parse_and_compile" or (what == "parse_and_try_run" and ".is_err()" in body):
        return built(name, source, arguments[1] if len(arguments) > 1 else "", [("refuse",)])
    try:
        if what == "drive_fb":
            steps = table_steps(resolve(arguments[2], known), known)
        elif what.startswith("assert_run"):
            return macro("", "e2e_" + what.removeprefix("assert_run_"), [name, *([arguments[1]] if "_with" in what or "_near" in what else []),
                                                                       repr_of(source or ""), arguments[-1]])[0]
        else:
            steps = statements(body, known, what == "parse_and_run", source or "")
            if not any(step[0] == "run" for step in steps):
                return Case(name, unreadable="not a program that runs")
    except (KeyError, ValueError, IndexError, TypeError) as error:
        return Case(name, unreadable=f"not read: {error!r}"[:90])
    return built(name, source, arguments[1] if len(arguments) > 1 else "", steps)


def end_of_statement(text, at):
    while at < len(text) and text[at] != ";":
        literal = rust_text.LITERAL.match(text, at)
        if literal:
            at = literal.end()
        elif text[at] in "([{":
            at = rust_text.closing(text, at) + 1
        else:
            at += 1
    return at


def resolve(text, known):
    """`format!("…{name}…")` and names become literals."""
    text = text.strip().lstrip("&").strip()
    found = re.match(r"format!\s*\(", text)
    if found:
        arguments = rust_text.split(text[found.end():rust_text.closing(text, found.end() - 1)])
        template = rust_text.string(arguments[0])
        given = list(arguments[1:])
        named = dict(part.split(" = ", 1) for part in given if re.match(r"\w+ = ", part))

        def insert(place):
            key = place[1]
            term = named.get(key, key) if key else given.pop(0)
            term = known.get(term.strip(), term)
            value = rust_text.value(term)
            return str(value) if value is not None else place[0]
        filled = re.sub(r"(?<!\{)\{(\w*)\}(?!\})", insert, template or "")
        return repr_of(filled.replace("{{", "{").replace("}}", "}"))
    while text in known and known[text] != text:
        text = known[text].strip().lstrip("&").strip()
    return text


def table_steps(text, known):
    """`&[Run(0), Write(1, 1), Expect(2, 0), Pulse { … }]`."""
    inner = text.strip().lstrip("&").strip()
    steps = []
    for item in rust_text.split(rust_text.without_comments(inner[1:-1])):
        name = re.match(r"(?:FbStep::)?(\w+)", item)[1]
        numbers = [rust_text.value(part.split(":")[-1]) for part in rust_text.split(item[item.index("(") + 1 if "(" in item else item.index("{") + 1:-1])]
        if name == "Run":
            steps.append(("run", numbers[0]))
        elif name == "Write":
            steps.append(("write", *numbers))
        elif name == "Expect":
            steps.append(("expect", *numbers, 0.0))
        else:
            slot, count, base = numbers
            for pulse in range(count):
                steps += [("write", slot, 1), ("run", base + pulse * 2), ("write", slot, 0), ("run", base + pulse * 2 + 1)]
    return steps


READS = [
    r"^bufs\.vars\[(\d+)\]\.as_\w+\(\)$",
    r"^vm\.(?:read_variable\w*)\((?:VarIndex::new\()?(\d+)\)?\)\.unwrap\(\)(?: as \w+)?$",
]


def statements(body, known, one_scan, source):
    """The writes, rounds and asserts of a body, in their order."""
    steps = [("run", 0)] if one_scan else []
    names = r"vm\.run_round|vm\.write_variable(?:_raw)?|assert_eq|assert|read_string"
    if re.search(r"\bfor \w+ in\b", body):
        raise ValueError("a loop")
    for name, arguments, _ in rust_text.calls(body, names):
        if name.endswith("run_round"):
            steps.append(("run", rust_text.value(arguments[0])))
        elif "write_variable" in name:
            steps.append(("write", int(re.search(r"\d+", arguments[0])[0]), rust_text.value(arguments[1])))
        elif name == "assert_eq":
            steps.append(assertion(*arguments[:2], known, source))
        elif name == "assert":
            steps.append(near(arguments[0], known))
    if not any(step[0] != "run" and step[0] != "write" for step in steps):
        raise ValueError("no value is wanted")
    return steps


def assertion(left, right, known, source):
    left = re.sub(r"\s+", "", known.get(left, left)) if left in known else re.sub(r"\s+", "", left)
    wanted = rust_text.value(known.get(right.strip(), right))
    if wanted is None:
        raise ValueError(f"wanted {right}"[:60])
    for pattern in READS:
        found = re.match(pattern, left)
        if found:
            return ("expect", int(found[1]), wanted, 0.0)
    text = re.match(r"read_string\(&bufs\.data_region,(\w+)\)", left)
    if text:
        return ("text", place_of(known.get(text[1], text[1])), wanted)
    raise ValueError(f"a read of {left}"[:70])


def place_of(text):
    """Before the string that is read there are as many strings as `string_offset(&[…])` has lengths."""
    text = text.strip()
    if text == "0":
        return 0
    lengths = re.fullmatch(r"string_offset\(&\[([\d,\s]*)\]\)", text)
    if not lengths:
        raise ValueError(f"the place {text}"[:60])
    return len([part for part in lengths[1].split(",") if part.strip()])


def near(condition, known):
    """`(slot - wanted).abs() < tolerance`, or a BOOL."""
    found = re.match(r"^\((.+) - (.+)\)\.abs\(\) < (.+)$", condition, re.DOTALL)
    if not found:
        raise ValueError(f"assert {condition}"[:60])
    step = assertion(found[1].strip(), found[2], known, "")
    return (*step[:3], rust_text.value(found[3]))


def dialect_of(options):
    for name, dialect in DIALECTS.items():
        if name in options:
            return dialect
    return "codesys" if any(word in options for word in ALSO_CODESYS) else "iec3"


def built(name, source, options, steps):
    """Slots become paths, times become scans."""
    if source is None:
        return Case(name, unreadable="its source is not written out")
    program = re.search(r"\bPROGRAM\s+(\w+)", source, re.IGNORECASE)
    if not program:
        return Case(name, unreadable="it has no PROGRAM")
    case = Case(name, source, dialect_of(options), program[1], ordinals=iec_text.ordinals(source))
    if steps == [("refuse",)]:
        case.refused = True
        return case
    slots, texts = paths(source, program[1])
    if "Rusty" in options:
        # Two globals of its own, the time since it started, come first there.
        slots = [("", "STRING"), ("", "STRING"), *slots]
    tick = tick_of(source, steps)
    start = next(step[1] for step in steps if step[0] == "run")
    scan = 0
    pending = []
    for step in steps:
        if step[0] == "run":
            scan = (step[1] - start) // tick + 1 if tick else scan + 1
            # Where time matters there are scans between theirs, which must not see the value yet.
            case.writes += [Write(scan, path, value) for path, value in pending]
            pending = []
        elif step[0] == "text":
            case.expected.append(Expected(texts[step[1]][0], step[2], 0.0, scan))
        elif step[1] >= len(slots):
            return Case(name, unreadable="a slot that has no name")
        elif step[-1 if step[0] == "write" else 2] is None:
            return Case(name, unreadable="a value that needs Rust")
        elif step[0] == "write":
            path, kind = slots[step[1]]
            pending.append((path, literal(step[2], kind)))
        else:
            path, kind = slots[step[1]]
            if kind.upper().startswith(("STRING", "WSTRING")):
                return Case(name, unreadable="a value that is not a number")
            case.expected.append(Expected(path, narrowed(step[2], kind), step[3], scan))
    case.scans = max(scan, 1)
    if tick:
        case.interval_ms = tick // 1000
    if case.scans > 20_000:
        return Case(name, unreadable="too many scans")
    return case


def paths(source, program):
    """The path of each slot: globals, then the program's variables; and those of the strings among them."""
    outside = re.sub(r"\b(PROGRAM|FUNCTION_BLOCK|FUNCTION)\b.*?\bEND_\1\b", "", source, flags=re.IGNORECASE | re.DOTALL)
    found = [(name, kind) for section, name, kind in iec_text.variables(outside) if section == "VAR_GLOBAL"]
    own = iec_text.unit(source, program)
    found += [(f"{program}.{name}", kind) for section, name, kind in iec_text.variables(own[1]) if section != "VAR_EXTERNAL"]
    return found, [item for item in found if item[1].upper().startswith(("STRING", "WSTRING"))]


TIMED = re.compile(r"\b(TON|TOF|TP|TIME\s*\(\s*\)|LTIME\s*\(\s*\)|__SYSTEM_UP)", re.IGNORECASE)


def tick_of(source, steps):
    """µs per scan if time matters: a divisor of all times; None if only the order of scans does."""
    times = [step[1] for step in steps if step[0] == "run"]
    if not TIMED.search(source) or len(set(times)) < 2:
        return None
    tick = 0
    for time in times:
        a, b = tick, time - times[0]
        while b:
            a, b = b, a % b
        tick = a
    return tick if tick >= 1000 else None


def literal(value, kind):
    if kind.upper() == "BOOL":
        return "TRUE" if value else "FALSE"
    return f"T#{value}ms" if kind.upper() == "TIME" else str(value)


RANGES = {"BYTE": 8, "USINT": 8, "WORD": 16, "UINT": 16, "DWORD": 32, "UDINT": 32, "LWORD": 64, "ULINT": 64}


def narrowed(value, kind):
    """A slot has 32 or 64 bits and a sign; an unsigned variable has none."""
    bits = RANGES.get(kind.upper())
    return value + (1 << max(bits, 32)) if bits and isinstance(value, int) and value < 0 else value
