"""Packages installed where there is no Rust, and used there as a person would."""

import contextlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from product import ROOT, Product

# Nothing of the machine's own tools but what every Linux has.
PATH = "/usr/bin:/bin"
ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/")


class Failed(Exception):
    """What is installed does not do what it should."""


@dataclass(frozen=True)
class Place:
    """A bare environment."""

    name: str
    # Before the words of a command: they empty the environment, and enter a root file system.
    enter: list[str]
    # Where commands run, seen from outside.
    folder: Path
    # Below which packages put their files, seen from outside.
    prefix: Path

    def command(self, words: list[str], folder: Path | None = None) -> subprocess.CompletedProcess:
        """Runs to the end; fails with what was said."""
        began = time.monotonic()
        done = subprocess.run([*self.enter, *words], cwd=folder or self.folder, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, check=False)
        shown = " ".join(words)
        if done.returncode != 0:
            raise Failed(f"{self.name}: `{shown}` ended with {done.returncode}\n{done.stdout}{done.stderr}")
        print(f"{self.name}: {shown}  {time.monotonic() - began:.1f} s", flush=True)
        return done


def bare(path: str, home: Path) -> list[str]:
    """An environment with nothing in it but the paths of programs."""
    return ["env", "-i", f"PATH={path}", f"HOME={home}", "LANG=C.UTF-8"]


def empty_venv(folder: Path) -> Place:
    """Python's virtual environment, and no Rust on the PATH."""
    work = folder / "work"
    work.mkdir()
    subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
    return Place("venv", bare(f"{folder}/venv/bin:{PATH}", work), work, folder / "venv")


def venv(folder: Path, files: Path) -> Place:
    """Such an environment with the wheel in it."""
    place = empty_venv(folder)
    place.command(["pip", "install", "--quiet", "--no-index", "--disable-pip-version-check", "--find-links", str(files),
                   "onescan"])
    return place


def walk(place: Place, version: str, with_python: bool = True) -> None:
    """From the version to a passing test, a plant in Python, and the page."""
    said = place.command(["onescan", "--version"]).stdout.strip()
    _equal(place, "the version", said, f"onescan {version}")
    for file in ("share/man/man1/onescan.1", "share/bash-completion/completions/onescan"):
        if not (place.prefix / file).is_file() and not (place.prefix / f"{file}.gz").is_file():
            raise Failed(f"{place.name}: there is no {place.prefix / file}")
    place.command(["onescan", "new", "my-cell"])
    if "digest" not in place.command(["onescan", "run", "my-cell"]).stdout:
        raise Failed(f"{place.name}: `onescan run` names no digest")
    place.command(["onescan", "test", "my-cell"])
    place.command(["onescan", "review", "my-cell", "--accept-all"])
    place.command(["onescan", "test", "my-cell", "--check"])
    shutil.copytree(ROOT / "scenarios/shear", place.folder / "shear")
    # Its snapshots were reviewed elsewhere: each passes only if the digest of all its steps is equal.
    place.command(["onescan", "test", "shear", "--check"])
    if with_python:
        place.command(["onescan", "new", "my-plant", "--template", "python"])
        place.command(["onescan", "run", "my-plant"])
    _page(place)


def _equal(place: Place, what: str, found: object, expected: object) -> None:
    if found != expected:
        raise Failed(f"{place.name}: {what} is {found!r}, not {expected!r}")


def _page(place: Place) -> None:
    """The page of a run has the bytes that Node built; without these it has none."""
    page = sorted((ROOT / "web/dist").glob("*"))
    with _served(place) as (address, said):
        if "there is no page there" in said:
            if page:
                raise Failed(f"{place.name}: the program was built before its page: {said}")
            print(f"{place.name}: the program was built without its page, which is not tried")
            return
        for path in page:
            name = "" if path.name == "index.html" else path.name
            with urllib.request.urlopen(address + name, timeout=20) as answer:
                _equal(place, f"{path.name} as it is served", answer.read() == path.read_bytes(), True)
    print(f"{place.name}: the page is served as it was built, {len(page)} files")


@contextlib.contextmanager
def _served(place: Place) -> Iterator[tuple[str, str]]:
    """A run with its page: the address, and what was said before the first step."""
    words = ["onescan", "run", "my-cell", "--web=127.0.0.1:0", "--until", "1h"]
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen([*place.enter, *words], cwd=place.folder, stdout=subprocess.DEVNULL, stderr=said,
                                   stdin=subprocess.DEVNULL)
        try:
            for _ in range(200):
                said.seek(0)
                text = said.read()
                if process.poll() is not None:
                    raise Failed(f"{place.name}: `{' '.join(words)}` ended with {process.returncode}\n{text}")
                found = ADDRESS.search(text)
                if found:
                    # What else there is to say of the page follows at once.
                    time.sleep(0.2)
                    said.seek(0)
                    yield found[0], said.read()
                    return
                time.sleep(0.1)
            raise Failed(f"{place.name}: `{' '.join(words)}` names no address\n{text}")
        finally:
            process.terminate()
            process.wait()


def root(given: Path | None, files: Path, of: Product) -> None:
    """A root file system of Debian: the archive, the Debian package, the steps of the container file."""
    with tempfile.TemporaryDirectory(prefix="onescan-root-") as folder:
        base = given or Path(folder) / "base"
        if given is None:
            subprocess.run(["mmdebstrap", "--quiet", "--variant=minbase", "bookworm", base], check=True)
        for name, steps in _steps(files, of).items():
            _in_root(Path(folder) / name, base, name, files, steps, of.version)


def _steps(files: Path, of: Product) -> dict[str, list[str]]:
    """How each package is installed, as its reader would type it; all files are in `/files`."""
    archive = next(path.name for path in files.iterdir() if path.name.startswith(f"onescan-{of.version}-linux-{of.needs.machine}"))
    deb = next(path.name for path in files.iterdir() if path.suffix == ".deb")
    container = [line.removeprefix("RUN ") for line in (ROOT / "Containerfile").read_text().splitlines()
                 if line.startswith("RUN ")]
    return {
        "archive": [f"tar -xzf /files/{archive} -C /usr/local --strip-components=1"],
        "deb": [f"dpkg --install /files/{deb}"],
        "container": [f"cp /files/{deb} /tmp/", *container],
    }


def _in_root(folder: Path, base: Path, name: str, files: Path, steps: list[str], version: str) -> None:
    subprocess.run(["cp", "--archive", base, folder], check=True)
    shutil.copytree(files, folder / "files", ignore=lambda _, names: [name for name in names if name == "crates"])
    work = folder / "work"
    work.mkdir()
    # With /proc, as every system and container has it; it is unmounted with the process.
    mounted = 'mount -t proc proc "$0/proc" && exec chroot "$0" "$@"'
    enter = [*bare("/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", Path("/work")),
             "unshare", "--mount", "--propagation", "private", "sh", "-c", mounted, str(folder)]
    place = Place(name, enter, work, folder / ("usr/local" if name == "archive" else "usr"))
    for step in steps:
        place.command(["sh", "-c", f"cd / && {step}"])
    inside = [*enter, "sh", "-c", 'cd /work && exec "$@"', "sh"]
    walk(Place(name, inside, work, place.prefix), version, with_python=False)
    shutil.rmtree(folder)
