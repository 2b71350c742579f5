"""Reads what a harness needs of ST: which variables a unit declares, in which order, and the values of enumerations."""

import re


def without_comments(text):
    """Comments become blanks."""
    return re.sub(r"\(\*.*?\*\)|/\*.*?\*/|//[^\n]*|'(?:[^'$]|\$.)*'|\"(?:[^\"$]|\$.)*\"",
                  lambda found: found[0] if found[0][0] in "'\"" else " " * len(found[0]), text, flags=re.DOTALL)


def unit(text, name):
    """The text of a PROGRAM, FUNCTION or FUNCTION_BLOCK and its kind, or None."""
    found = re.search(rf"\b(PROGRAM|FUNCTION_BLOCK|FUNCTION)\s+{re.escape(name)}\b(.*?)\bEND_\1\b", text, re.IGNORECASE | re.DOTALL)
    return (found[1].upper(), found[0]) if found else None


def variables(text):
    """(section, name, type) of each variable that a unit declares."""
    for block in re.finditer(r"\b(VAR(?:_[A-Z]+)?)\b(.*?)\bEND_VAR\b", without_comments(text), re.IGNORECASE | re.DOTALL):
        inner = re.sub(r"^\s*(?:CONSTANT|RETAIN|NON_RETAIN|PERSISTENT)\b", "", block[2], flags=re.IGNORECASE)
        inner = re.sub(r"^\s*\{[^}]*\}", "", inner)
        for declaration in re.finditer(r"([\w\s,]+?)(?:\bAT\b[^:;]*)?:(?!=)\s*([^;]*);", inner):
            kind = declaration[2].partition(":=")[0].strip()
            for name in declaration[1].split(","):
                yield block[1].upper(), name.strip(), kind


def ordinals(text):
    """The number of each value of each enumeration whose values are not given."""
    known = {}
    for found in re.finditer(r":\s*\(([^()]*)\)", without_comments(text)):
        following = 0
        for item in found[1].split(","):
            parts = re.fullmatch(r"\s*(\w+)\s*(?::=\s*(-?\d+)\s*)?", item)
            if not parts:
                break
            following = int(parts[2]) if parts[2] else following
            known.setdefault(parts[1].upper(), following)
            following += 1
    return known
