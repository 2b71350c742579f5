"""The commands of docs/ci.md, run as a CI server runs them: in a folder with a TwinCAT project and no onescan."""

import re
import shutil
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from product import ROOT, project
from tried import PATH, Failed, Place, bare

PROJECT = Path(__file__).resolve().parent / "dosing"
SERVERS = ["GitHub Actions", "GitLab CI", "Azure Pipelines", "Jenkins", "Any other server"]
VERSION = re.compile(r"(?:==|@v|ref: v|(?:ersion|ERSION): \"|default: \"|onescan[-_])(\d+\.\d+\.\d+)\b")
# What the test programs of the project are, as a report for CI servers has them.
PASSED = 'tests="2" failures="0" errors="0"'


@dataclass(frozen=True)
class Job:
    """What a server runs for the file that the document shows."""

    server: str
    # How many lines somebody writes into their repository.
    lines: int
    commands: list[str]
    variables: dict[str, str]


def jobs() -> list[Job]:
    """The job of each server, from the document and the files that it takes in."""
    text = (ROOT / "docs/ci.md").read_text(encoding="utf-8")
    for file in ("docs/ci.md", "ci/gitlab.yml", "action.yml", "README.md"):
        named = set(VERSION.findall((ROOT / file).read_text(encoding="utf-8")))
        if not named <= {project()["version"]}:
            raise Failed(f"{file} names {', '.join(sorted(named))}, and this is {project()['version']}")
    return [_job(server, _block(text, server)) for server in SERVERS]


def _block(text: str, heading: str) -> str:
    """The first block of code below a heading."""
    found = re.search(rf"^## {re.escape(heading)}\n.*?^```\w+\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
    if not found:
        raise Failed(f"docs/ci.md has no block below `{heading}`")
    return found[1]


def _job(server: str, block: str) -> Job:
    variables: dict[str, str] = {}
    if server == "GitHub Actions":
        action = (ROOT / "action.yml").read_text(encoding="utf-8")
        inputs = dict(re.findall(r'^  (\w+):\n(?:    description:.*\n)?    default: "?(.*?)"?$', action, re.MULTILINE))
        inputs |= dict(re.findall(r"^          (\w+): (.*)$", block, re.MULTILINE))
        commands = [re.sub(r"\$\{\{ inputs\.(\w+) \}\}", lambda use: inputs[use[1]], command)
                    for command in _listed(action, "run")]
    elif server == "GitLab CI":
        template = (ROOT / "ci/gitlab.yml").read_text(encoding="utf-8")
        for source in (template, block):
            variables |= dict(re.findall(r'^    (ONESCAN_\w+): "?(.*?)"?$', source, re.MULTILINE))
        script = re.search(r"^  script:\n((?:    - .*\n)+)", template, re.MULTILINE)
        commands = [line.strip().removeprefix("- ") for line in script[1].splitlines()] if script else []
    elif server == "Azure Pipelines":
        commands = _listed(block, "script")
    elif server == "Jenkins":
        commands = re.findall(r"sh '(.*)'", block)
    else:
        commands = [line for line in block.splitlines() if line]
    if len(commands) < 2:
        raise Failed(f"docs/ci.md: no commands found for {server}")
    return Job(server, sum(1 for line in block.splitlines() if line), commands, variables)


def _listed(text: str, key: str) -> list[str]:
    """The commands of `- run: COMMAND`, also over several lines with `>`."""
    commands = []
    lines = iter(text.splitlines())
    for line in lines:
        found = re.match(rf"( *)- {key}: (.*)$", line)
        if not found:
            continue
        command = found[2]
        if command == ">":
            deeper = " " * (len(found[1]) + 4)
            taken = []
            for more in lines:
                if not more.startswith(deeper):
                    break
                taken.append(more.strip())
            command = " ".join(taken)
        commands.append(command)
    return commands


def walk(venv: Place, files: Path, servers: list[str] | None = None) -> None:
    """Runs each job in a copy of the project, beginning without onescan."""
    for job in jobs():
        if servers is None or job.server in servers:
            _run(job, venv, files)


def _run(job: Job, venv: Place, files: Path) -> None:
    folder = venv.folder / job.server.split()[0].lower()
    shutil.copytree(PROJECT, folder)
    subprocess.run([venv.prefix / "bin/pip", "uninstall", "--quiet", "--yes", "onescan"], check=True, capture_output=True)
    summary = folder / "summary.md"
    given = {**job.variables, "PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(files), "CI": "true",
             "PIP_DISABLE_PIP_VERSION_CHECK": "1", "PIP_ROOT_USER_ACTION": "ignore",
             "GITHUB_STEP_SUMMARY": str(summary)}
    enter = [*bare(f"{venv.prefix}/bin:{PATH}", folder), *(f"{name}={value}" for name, value in given.items())]
    place = Place(job.server, [*enter, "bash", "--noprofile", "--norc", "-eo", "pipefail", "-c"], folder, venv.prefix)
    began = time.monotonic()
    for command in job.commands:
        place.command([command])
    took = time.monotonic() - began
    if PASSED not in (folder / "onescan.xml").read_text(encoding="utf-8"):
        raise Failed(f"{job.server}: onescan.xml is not the report of two tests that passed")
    print(f"{job.server}: {job.lines} lines, {took:.1f} s from an empty job to the verdict", flush=True)
    if job.server == "GitHub Actions":
        _fails(place, job.commands[-1], summary)


def _fails(place: Place, command: str, summary: Path) -> None:
    """A fault in the project fails the job, at the line of the assert, and on the job's page."""
    source = place.folder / "Dosing/POUs/FB_Dosing.TcPOU"
    source.write_text(source.read_text(encoding="utf-8").replace("bFine := bCoarse OR ", "bFine := "), encoding="utf-8")
    summary.unlink(missing_ok=True)
    done = subprocess.run([*place.enter, command], cwd=place.folder, capture_output=True, text=True, check=False)
    if done.returncode != 1:
        raise Failed(f"{place.name}: a project with a fault ends with {done.returncode}\n{done.stdout}{done.stderr}")
    if "::error file=tests/dosing.st,line=" not in done.stdout:
        raise Failed(f"{place.name}: a failed assert is not shown at its line\n{done.stdout}")
    if "TEST_Doses_in_two_speeds" not in summary.read_text(encoding="utf-8"):
        raise Failed(f"{place.name}: a failed test is not on the page of the job")
