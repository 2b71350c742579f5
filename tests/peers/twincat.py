"""Parses TwinCAT objects below the folder that is named with blark; prints how many there are, and each that is wrong."""

import pathlib
import sys

from blark.parse import parse

count = 0
for path in sorted(pathlib.Path(sys.argv[1]).rglob("*.Tc*")):
    for result in parse(path):
        count += 1
        if result.exception is not None:
            print(f"{path.name}: {str(result.exception).splitlines()[0]}")
print(count)
