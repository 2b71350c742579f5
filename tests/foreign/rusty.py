"""RuSTy's correctness tests, `tests/correctness/**.rs` of its repository: programs in tests in Rust.

`main` is a PROGRAM, whose variables are fields of a Rust structure in the same order, or a FUNCTION, whose return value is
`res`. A test with other Rust around it (loops, external functions, C strings, pointers) is `unreadable`.
"""

import re

import iec_text
import rust_text
from case import Case, Expected

TESTS = "tests/correctness"
# It takes ST without END_VAR's semicolons, with methods, pointers and initial values as CODESYS has them.
DIALECT = "codesys"
# All its times are in ns.
NS_PER_MS = 1_000_000
RESULT = "harness_result"


def cases(folder):
    """Every test of the suite."""
    for path in sorted((folder / TESTS).rglob("*.rs")):
        text = path.read_text()
        outside = structures(re.sub(r"\bfn \w+.*?\n}\n", "", text, flags=re.DOTALL))
        short = path.relative_to(folder / TESTS).with_suffix("")
        for attributes, name, _, body in rust_text.functions(text):
            if "#[test]" in attributes and "ignore" not in attributes.rpartition("#[test]")[2]:
                yield test(f"{short}::{name}", rust_text.without_comments(body), outside)


def structures(text):
    """The fields of each structure, in order."""
    return {found[1]: [part.split(":")[0].replace("pub", "").strip() for part in rust_text.split(rust_text.without_comments(found[2]))]
            for found in re.finditer(r"struct (\w+)(?:<[^>]*>)?\s*\{([^}]*)\}", text)}


def test(name, body, outside):
    fields = outside | structures(body)
    local = {}
    for found in re.finditer(r"let (\w+)(?::\s*[&\w]+)?\s*=\s*(?=r?#*\")", body):
        local[found[1]] = rust_text.string(rust_text.LITERAL.match(body, found.end())[0])
    runs = list(rust_text.calls(body, r"compile_and_run|compile_and_run_no_params"))
    if len(runs) != 1:
        return Case(name, unreadable="not one run of one source")
    first = re.sub(r"\.(to_string|into)\(\)$", "", runs[0][1][0]).lstrip("&").strip()
    source = local.get(first) or rust_text.string(first)
    if source is None:
        return Case(name, unreadable="its source is not written out")
    if re.search(r"=\s*\w+\s*\{[^}]*:\s*(?:true|[^,}]*[1-9])", body):
        return Case(name, unreadable="its variables begin with values from Rust")
    wanted = list(asserts(body))
    if not wanted or None in wanted:
        return Case(name, unreadable="its asserts need Rust")
    return built(name, source, wanted, instance(runs[0][1], body, fields))


def instance(arguments, body, fields):
    """The name of the variable that holds the PROGRAM's variables, and their names there in order."""
    if len(arguments) < 2:
        return "", []
    variable = re.sub(r"^&\s*(mut )?", "", arguments[1]).strip()
    kind = re.search(rf"let (?:mut )?{re.escape(variable)}\s*(?::\s*(\w+))?\s*=\s*(\w+)?", body)
    names = [word for word in (kind.groups() if kind else ()) if word in fields]
    if not names and kind and kind[2] == "new":
        names = ["MainType"]
    return variable, fields.get(names[0], []) if names else []


def asserts(body):
    """(what, wanted, tolerance) of each assert; None for one that is not a value."""
    for name, arguments, _ in rust_text.calls(body, r"assert_eq|assert_almost_eq|assert|assert_ne"):
        if name == "assert":
            text = arguments[0]
            yield (text.lstrip("!").strip(), int(not text.startswith("!")), 0.0) if re.fullmatch(r"!?[\w.]+", text) else None
            continue
        sides = [(rust_text.value(side), side.strip()) for side in arguments[:2]]
        values = [value for value, _ in sides if value is not None]
        places = [side for value, side in sides if value is None]
        if name == "assert_ne" or len(values) != 1:
            yield None
        elif re.fullmatch(r"\w+(\.\w+(\[\d+\])*)*", places[0]):
            yield places[0], values[0], 1e-5 if name == "assert_almost_eq" else 0.0
        else:
            yield None


def built(name, source, wanted, instance_of):
    variable, fields = instance_of
    main = iec_text.unit(source, "main")
    if not main:
        return Case(name, unreadable="it has no `main`")
    kind, text = main
    case = Case(name, source, DIALECT, ordinals=iec_text.ordinals(source), per_ms=NS_PER_MS, per_s=1000 * NS_PER_MS)
    result = re.match(r"FUNCTION\s+main\s*:\s*([^\n;]+?)\s*(?:$|;|\bVAR)", text, re.IGNORECASE | re.MULTILINE)
    own = [item for item in iec_text.variables(text)]
    if kind == "FUNCTION":
        kind_of_result = result[1] if result else None
        call = f"{RESULT} := main();" if kind_of_result else "main();"
        case.source += (f"\nPROGRAM harness\nVAR {RESULT} : {kind_of_result or 'DINT'}; END_VAR\n{call}\nEND_PROGRAM\n")
        case.program = "harness"
    for place, value, tolerance in wanted:
        if place == "res" and kind == "FUNCTION" and result:
            path = f"harness.{RESULT}"
        elif kind == "PROGRAM" and variable and place.startswith(variable + "."):
            path = program_path(place.removeprefix(variable + "."), fields, own)
        else:
            path = None
        if path is None:
            return Case(name, unreadable="a value that has no path")
        case.expected.append(Expected(path, value, tolerance or tolerance_of(value)))
    return case


def program_path(place, fields, own):
    """The variable at the same place of the declaration; the same name where there is one."""
    first, rest = re.match(r"(\w+)(.*)", place).groups()
    names = {item[1].lower(): item[1] for item in own}
    if first.lower() in names:
        return f"main.{names[first.lower()]}{rest}" if "[" not in rest else None
    if first in fields and fields.index(first) < len(own) and not rest:
        return f"main.{own[fields.index(first)][1]}"
    return None


def tolerance_of(value):
    """A REAL that is wanted is written as the nearest f32."""
    return abs(value) * 1e-6 if isinstance(value, float) else 0.0
