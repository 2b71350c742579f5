"""Reads what tests in Rust say: functions, calls of macros and functions, string literals, numbers. No parser: enough of one."""

import re

LITERAL = re.compile(r'r(#*)"(.*?)"\1|"((?:[^"\\]|\\.)*)"', re.DOTALL)
ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "0": "\0", "\\": "\\", '"': '"', "'": "'"}


def closing(text, at):
    """The index of the bracket that closes the one at `at`."""
    pairs = {"(": ")", "[": "]", "{": "}"}
    depth = []
    while at < len(text):
        string = LITERAL.match(text, at)
        if string:
            at = string.end()
            continue
        if text.startswith("//", at):
            at = text.find("\n", at)
            if at < 0:
                break
        character = re.match(r"'(?:\\.|[^'\\])'", text[at:at + 5])
        if character:
            at += character.end()
            continue
        if text[at] in pairs:
            depth.append(pairs[text[at]])
        elif depth and text[at] == depth[-1]:
            depth.pop()
            if not depth:
                return at
        at += 1
    return len(text)


def split(text):
    """The arguments between two brackets."""
    parts, start, at = [], 0, 0
    while at < len(text):
        string = LITERAL.match(text, at)
        if string:
            at = string.end()
        elif text[at] in "([{":
            at = closing(text, at) + 1
        elif text[at] == ",":
            parts.append(text[start:at].strip())
            at += 1
            start = at
        else:
            at += 1
    parts.append(text[start:].strip())
    return [part for part in parts if part]


def calls(text, name):
    """The arguments of every call of a function or macro whose name matches, with the name and the place."""
    for found in re.finditer(rf"\b({name})(!?)\s*\(", text):
        end = closing(text, found.end() - 1)
        yield found[1], split(without_comments(text[found.end():end])), found.start()


def without_comments(text):
    """The text without its `//` comments; those inside of strings stay."""
    out, at = [], 0
    while at < len(text):
        string = LITERAL.match(text, at)
        if string:
            out.append(string[0])
            at = string.end()
        elif text.startswith("//", at):
            end = text.find("\n", at)
            at = len(text) if end < 0 else end
        else:
            out.append(text[at])
            at += 1
    return "".join(out)


def string(text):
    """The characters of a literal, or None."""
    found = LITERAL.fullmatch(text.strip().removesuffix(".to_string()").removesuffix(".into()").lstrip("&").strip())
    if not found:
        return None
    if found[2] is not None:
        return found[2]
    joined = re.sub(r"\\\n\s*", "", found[3])
    return re.sub(r"\\(u\{([0-9a-fA-F]+)\}|x([0-9a-fA-F]{2})|.)", escaped, joined, flags=re.DOTALL)


def escaped(found):
    code = found[2] or found[3]
    return chr(int(code, 16)) if code else ESCAPES.get(found[1], found[1])


def value(text):
    """A number, a BOOL or a string that is written out; None for what would need Rust."""
    text = text.strip().lstrip("&").strip()
    if text in ("true", "false"):
        return int(text == "true")
    literal = string(text)
    if literal is not None:
        return literal
    byte = re.fullmatch(r"b'(\\?.)'", text)
    if byte:
        return ord(byte[1][-1])
    text = re.sub(r"(?<=[0-9a-fA-F.])_?(?:[iu](?:8|16|32|64|size)|f32|f64)$", "", text)
    text = re.sub(r"\s+as\s+\w+(?:\s+as\s+\w+)*$", "", text.strip("()") if "(" in text else text)
    text = re.sub(r"(?<=[0-9a-fA-F.])_?(?:[iu](?:8|16|32|64|size)|f32|f64)$", "", text)
    constant = re.fullmatch(r"-?(i8|i16|i32|i64|u8|u16|u32|u64)::(MAX|MIN)", text)
    if constant:
        width, signed = int(constant[1][1:]), constant[1][0] == "i"
        least, most = (-(1 << width - 1), (1 << width - 1) - 1) if signed else (0, (1 << width) - 1)
        return most if constant[2] == "MAX" else least
    plain = text.replace("_", "")
    try:
        if re.fullmatch(r"-?0[xbo][0-9a-fA-F]+", plain):
            return int(plain, 0)
        return int(plain) if re.fullmatch(r"-?\d+", plain) else float(plain)
    except ValueError:
        return None


def functions(text):
    """Each `fn` with the attributes above it: (attributes, name, parameters, body)."""
    for found in re.finditer(r"((?:^[ \t]*(?:#\[|//).*\n|^[ \t]*#\[[^\n]*\[\s*\n(?:.*\n)*?^[ \t]*\]\)\]\n)*)"
                             r"^[ \t]*(?:pub )?fn (\w+)(?:<[^>]*>)?\s*\(", text, re.MULTILINE):
        close = closing(text, found.end() - 1)
        start = text.find("{", close)
        yield attributes_above(text, found.start(), found.end()), found[2], text[found.end():close], text[start + 1:closing(text, start)]


def attributes_above(text, start, end):
    """All attributes between the function before and this one."""
    before = text.rfind("\n}\n", 0, end)
    return text[max(before, 0):end] if before >= 0 else text[:end]
