"""An environment with packages from PyPI, in which a comparison with other programs goes on."""

import os
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")


def enter(name, script, packages, what):
    """Goes on with `tests/NAME/compare` in `target/NAME`, which has the packages; exit code 3 where that cannot be made."""
    place = TARGET / name
    python = place / "bin" / "python"
    if Path(sys.prefix).resolve() == place.resolve():
        return
    ready = place / "ready"
    if not ready.exists() or ready.read_text() != "\n".join(packages):
        try:
            venv.create(place, with_pip=True, clear=True)
            words = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages]
            subprocess.run(words, check=True, capture_output=True, text=True)
        except (OSError, subprocess.CalledProcessError) as failed:
            why = (getattr(failed, "stderr", None) or str(failed)).strip().splitlines()[-1:]
            print(f"tests/{name}/compare: {what} cannot be installed into {place}: {' '.join(why)}", file=sys.stderr)
            sys.exit(3)
        ready.write_text("\n".join(packages))
    os.execv(python, [python, script, *sys.argv[1:]])
