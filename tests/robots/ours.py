"""A file as onescan has it: a scene with nothing but this robot."""

import json
import subprocess
import tempfile
from pathlib import Path

# what the scene calls its robot
NAME = "r"


def text(value):
    return json.dumps(str(value))


def scene(file, packages, keys):
    """The scene, with further keys of its robot."""
    lines = ["version = 1", "[[urdf]]", f'name = "{NAME}"', f"file = {text(file.path)}"]
    lines += [f"{key} = {value}" for key, value in keys.items()]
    if file.kind == "robot":
        named = ", ".join(f"{text(name)} = {text(place)}" for name, place in packages.items())
        given = ", ".join(f"{key} = {text(value)}" for key, value in file.arguments.items())
        lines += [f"packages = {{ {named} }}", f"arguments = {{ {given} }}"]
    return "\n".join(lines) + "\n"


class Reading:
    """What became of a reading: the scene as data, or why there is none."""

    def __init__(self, data=None, refused=None):
        self.data, self.refused = data, refused


def read(program, folder, file, packages, keys, limit, dynamics):
    """Reads a robot, with its dynamics if they are wanted. Fails with TimeoutExpired, and with ChildProcessError where the program ends as it never should."""
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "plant.toml"
        path.write_text(scene(file, packages, keys))
        words = [program, "describe", path, "--format", "json", "--allow-path", folder]
        words += ["--dynamics"] if dynamics else []
        done = subprocess.run(words, capture_output=True, text=True, timeout=limit)
    if done.returncode == 0:
        return Reading(json.loads(done.stdout))
    if done.returncode not in (2, 3, 4) or "panicked" in done.stderr:
        raise ChildProcessError(f"exit code {done.returncode}: {done.stderr[-300:]}")
    return Reading(refused=done.stderr)


def coordinates(data):
    """Where each joint of one coordinate stands, by its name in the file."""
    found = {}
    for joint in data["joints"]:
        if joint["kind"] in ("prismatic", "revolute"):
            found[joint["name"].removeprefix(NAME + ".")] = joint["initial"]
    return found


def followers(data):
    return {joint["name"].removeprefix(NAME + ".") for joint in data["joints"] if joint.get("follows")}
