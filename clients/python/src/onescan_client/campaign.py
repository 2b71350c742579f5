"""Campaigns of faults, on this machine or on a cluster of Dask."""
from __future__ import annotations

import importlib
import io
import json
import os
import subprocess
import tarfile
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Optional, Sequence, Union

from .errors import CampaignFailed

# A part of a campaign with more parts than it can have runs: only the run without faults, which leaves the checkpoints.
_NO_RUN = "1000000000/1000000000"
_JOURNAL = "journal.jsonl"


@dataclass(frozen=True)
class Table:
    """What came of campaigns."""

    #: A run each: its `case`, `verdict`, `digest` and what was read out of it.
    runs: list[dict[str, Any]]
    #: A campaign each, with the counts of its verdicts.
    campaigns: list[dict[str, Any]]
    #: True if all verdicts are among those that the campaigns accept.
    passed: bool
    #: The same as the program writes it, a JSON object a line.
    text: str


def campaign(
    scenario: Union[str, "os.PathLike[str]"],
    name: Optional[str] = None,
    *,
    client: Any = None,
    parts: Optional[int] = None,
    program: str = "onescan",
    program_on_workers: Optional[str] = None,
    html: Optional[Union[str, "os.PathLike[str]"]] = None,
    junit: Optional[Union[str, "os.PathLike[str]"]] = None,
    on_part: Optional[Callable[[int, int], None]] = None,
) -> Table:
    """Does the campaigns of a scenario, or the one called `name`.

    With a `client` (`distributed.Client`) the runs are spread over its cluster in so many `parts`, four a worker by
    default. The scenario and the checkpoints travel as bytes: workers need the program and no folder in common. A part
    whose worker is lost is done again by another. The table is that of one process, to the byte.

    `on_part` is called with the number of parts that are done, and of all, whenever one is.

    Raises `CampaignFailed` if the program does not come to a table.
    """
    folder = Path(scenario)
    reports = ["--format", "json"]
    for option, path in (("--html", html), ("--junit", junit)):
        if path is not None:
            reports += [option, os.fspath(path)]
    if client is None:
        chosen = [name] if name is not None else []
        return _table(_run([program, "campaign", str(folder), *chosen, *reports], also_ends_with=(1,)))
    worker_program = program_on_workers or program
    packed = _pack(folder if folder.is_dir() else folder.parent)
    file = None if folder.is_dir() else folder.name
    of = parts or 4 * max(1, len(client.scheduler_info()["workers"]))
    # Its result is lost with its worker, but not what it is made of: then another one makes it again.
    trunk = client.submit(_trunk, worker_program, packed, file, name, pure=False)
    futures = [
        client.submit(_part, worker_program, packed, file, name, trunk, number, of, pure=False)
        for number in range(1, of + 1)
    ]
    with tempfile.TemporaryDirectory() as kept:
        folders = []
        for number, work in enumerate(_as_they_come(futures, on_part), start=1):
            folders.append(str(_unpack(work, Path(kept) / str(number))))
        chosen = ["--campaign", name] if name is not None else []
        words = [program, "campaign", "merge", str(folder), *folders, *chosen, *reports]
        return _table(_run(words, also_ends_with=(1,)))


def _as_they_come(futures: Sequence[Any], on_part: Optional[Callable[[int, int], None]]) -> list[bytes]:
    """The results of all parts, in their order."""
    # Whoever has a client has it.
    as_completed: Any = importlib.import_module("distributed").as_completed
    # Each is fetched as soon as it is there: what is here is lost with no worker.
    results: dict[Any, bytes] = {}
    for future in as_completed(futures):
        results[future.key] = future.result()
        if on_part is not None:
            on_part(len(results), len(futures))
    return [results[future.key] for future in futures]


def _trunk(program: str, packed: bytes, file: Optional[str], name: Optional[str]) -> bytes:
    """The run without faults on a worker: its journal and its checkpoints."""
    with tempfile.TemporaryDirectory() as place:
        work = Path(place) / "work"
        _campaign(program, _unpack(packed, Path(place) / "scenario"), file, name, work, _NO_RUN)
        return _pack(work)


def _part(
    program: str, packed: bytes, file: Optional[str], name: Optional[str], trunk: bytes, number: int, of: int
) -> bytes:
    """A part of the runs on a worker: the journals of its campaigns."""
    with tempfile.TemporaryDirectory() as place:
        work = _unpack(trunk, Path(place) / "work")
        _campaign(program, _unpack(packed, Path(place) / "scenario"), file, name, work, f"{number}/{of}")
        return _pack(work, only=_JOURNAL)


def _campaign(program: str, scenario: Path, file: Optional[str], name: Optional[str], work: Path, part: str) -> None:
    chosen = [name] if name is not None else []
    subject = scenario if file is None else scenario / file
    _run([program, "campaign", str(subject), *chosen, "--jobs", "1", "--keep", str(work), "--partition", part])


def _run(words: Sequence[str], also_ends_with: Sequence[int] = ()) -> "subprocess.CompletedProcess[str]":
    try:
        done = subprocess.run(words, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CampaignFailed(f"{words[0]} cannot be started: {error}") from error
    if done.returncode != 0 and done.returncode not in also_ends_with:
        raise CampaignFailed(done.stderr.strip() or f"{words[0]} ended with {done.returncode}")
    return done


def _table(done: "subprocess.CompletedProcess[str]") -> Table:
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    runs = [line for line in lines if "case" in line]
    campaigns = [line for line in lines if "case" not in line]
    return Table(runs, campaigns, done.returncode == 0, done.stdout)


def _pack(folder: Path, only: Optional[str] = None) -> bytes:
    """The files of a folder, or those of a name, as bytes."""
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w:gz") as archive:
        for path in sorted(folder.rglob("*" if only is None else only)):
            if path.is_file():
                archive.add(path, arcname=path.relative_to(folder).as_posix())
    return packed.getvalue()


def _unpack(packed: bytes, folder: Path) -> Path:
    """A folder with the files that were packed; no other place is written."""
    folder.mkdir(parents=True)
    with tarfile.open(fileobj=io.BytesIO(packed), mode="r:gz") as archive:
        for member in archive:
            place = (folder / member.name).resolve()
            content = archive.extractfile(member)
            if content is None or folder.resolve() not in place.parents:
                raise CampaignFailed(f"`{member.name}` is no file of this folder")
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content.read())
    return folder
