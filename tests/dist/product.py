"""What is packed: the program, what it says of itself, the Python client, the terms."""

import subprocess
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path

import elf
from archives import Entry

ROOT = Path(__file__).resolve().parent.parent.parent
CLIENT = ROOT / "clients/python/src"
SHELLS = {"bash": "share/bash-completion/completions/onescan", "zsh": "share/zsh/site-functions/_onescan",
          "fish": "share/fish/vendor_completions.d/onescan.fish"}
DOCUMENTS = {"README.md": "README.md", "CHANGELOG.md": "CHANGELOG.md", "LICENSE-APACHE": "LICENSE-APACHE",
             "LICENSE-MIT": "LICENSE-MIT", "web/LICENCES.md": "LICENCES-page.md"}


class NotReady(Exception):
    """Something is missing that a package must have."""


def project() -> dict:
    """What the manifest of the Python distribution says."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def epoch(given: str | None) -> int:
    """The time of all files in packages: SOURCE_DATE_EPOCH, else that of the commit."""
    if given:
        return int(given)
    done = subprocess.run(["git", "-C", ROOT, "log", "-1", "--format=%ct"], capture_output=True, text=True, check=False)
    return int(done.stdout) if done.returncode == 0 else 315532800


@dataclass(frozen=True)
class Product:
    """All that packages are made of."""

    version: str
    epoch: int
    needs: elf.Needs
    program: bytes
    # Paths below `share`, as in `share/man/man1/onescan.1`.
    shared: list[Entry]
    client: list[Entry]

    @property
    def file_name(self) -> str:
        return "onescan.exe" if self.needs.system == "windows" else "onescan"


def read(program: Path, pages_by: Path, epoch_s: int) -> Product:
    """Collects the files. `pages_by` prints completions and manual pages: the program, or one that runs here."""
    version = project()["version"]
    said = subprocess.run([pages_by, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    if said != f"onescan {version}":
        raise NotReady(f"{pages_by} is `{said}`, not version {version}")
    return Product(version, epoch_s, elf.needs(program), program.read_bytes(), _shared(pages_by), _client())


def _shared(program: Path) -> list[Entry]:
    found = []
    for shell, path in SHELLS.items():
        text = subprocess.run([program, "completions", shell], capture_output=True, check=True).stdout
        found.append(Entry(path, text))
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "man", "--output", folder], capture_output=True, check=True)
        for page in sorted(Path(folder).iterdir()):
            found.append(Entry(f"share/man/man1/{page.name}", page.read_bytes()))
    return found


def _client() -> list[Entry]:
    files = sorted(path for path in CLIENT.rglob("*") if path.suffix == ".py" or path.name == "py.typed")
    return [Entry(path.relative_to(CLIENT).as_posix(), path.read_bytes()) for path in files]


def documents() -> list[Entry]:
    """What is handed out beside the program."""
    return [Entry(name, (ROOT / path).read_bytes()) for path, name in DOCUMENTS.items()]
