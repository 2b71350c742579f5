"""Runs a program on a terminal of its own and types: KEYS COMMAND...

KEYS are groups of keys with commas between them; a group is typed when the program has asked once more. All
that the program wrote goes to standard output, and its exit code is this program's.
"""

import os
import pty
import sys

PROMPT = b"q done"

groups = sys.argv[1].split(",")
process, terminal = pty.fork()
if process == 0:
    os.execv(sys.argv[2], sys.argv[2:])
seen, typed = b"", 0
while True:
    try:
        some = os.read(terminal, 65536)
    except OSError:  # Linux says so when the program has ended
        break
    if not some:
        break
    seen += some
    while typed < len(groups) and typed < seen.count(PROMPT):
        os.write(terminal, groups[typed].encode())
        typed += 1
sys.stdout.buffer.write(seen.replace(b"\r\n", b"\n"))
sys.exit(os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]))
