"""What a folder has: files that may be robots, by publisher, and packages by name."""

import re

import known

ENDINGS = {".urdf", ".xacro", ".xml", ".mjcf"}
# the first element of a file, behind declaration and comments
ROOT = re.compile(r"\A\ufeff?\s*(?:<\?.*?\?>|<!--.*?-->|\s)*<(robot|mujoco)[\s>/]", re.S)
NAME = re.compile(r"<name>\s*([^<\s]+)\s*</name>")


class File:
    """A file whose first element is <robot> or <mujoco>, and the arguments that it is read with."""

    def __init__(self, path, publisher, kind, arguments):
        self.path, self.publisher, self.kind, self.arguments = path, publisher, kind, arguments

    def named(self, folder):
        given = " ".join(f"{key}={value}" for key, value in self.arguments.items())
        return f"{self.path.relative_to(folder)}{f' ({given})' if given else ''}"


def text_of(path):
    return path.read_bytes().decode("utf-8", "replace")


def files(folder):
    """Files in their order by path; of links to files, none."""
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() not in ENDINGS or not path.is_file() or path.is_symlink() or "srdf" in path.name:
            continue
        first = ROOT.match(text_of(path))
        if first:
            for arguments in known.arguments(path):
                yield File(path, path.relative_to(folder).parts[0], first[1], arguments)


def packages(folder):
    """Folders of packages by publisher and name."""
    by_publisher = {}
    for path in sorted(folder.rglob("package.xml")):
        name = NAME.search(text_of(path))
        if name:
            by_publisher.setdefault(path.relative_to(folder).parts[0], {}).setdefault(name[1], path.parent)
    return by_publisher


def packages_for(by_publisher, publisher):
    """What a file of a publisher may name: its packages first, then those of others."""
    known = {}
    for owner in [publisher, *by_publisher]:
        for name, place in by_publisher.get(owner, {}).items():
            known.setdefault(name, place)
    return known


def included(files):
    """Names of files of MuJoCo that others include: parts, not models."""
    parts = set()
    for file in files:
        if file.kind == "mujoco":
            parts.update(re.findall(r"<include\s+file\s*=\s*[\"']([^\"']+)", text_of(file.path)))
    # paths begin at the outermost file, which may be any
    return tuple("/" + name.removeprefix("./") for name in sorted(parts))
