"""The packages, each as a name and its bytes."""

import base64
import hashlib
import subprocess
from pathlib import Path

import product
from archives import Entry, ar, gzipped, tarred, zipped
from product import ROOT, NotReady, Product

DEBIAN_MACHINES = {"x86_64": "amd64", "aarch64": "arm64"}


def wheel(of: Product, level: int = 6) -> tuple[str, bytes]:
    """`pip install onescan`: the program on the PATH, and the Python client."""
    tag = f"py3-none-{of.needs.wheel_tag}"
    name = f"onescan-{of.version}"
    data, info = f"{name}.data", f"{name}.dist-info"
    tags = "".join(f"Tag: py3-none-{platform}\n" for platform in of.needs.wheel_tag.split("."))
    about = f"Wheel-Version: 1.0\nGenerator: onescan\nRoot-Is-Purelib: false\n{tags}"
    entries = [*of.client, Entry(f"{data}/scripts/{of.file_name}", of.program, True)]
    entries += [Entry(f"{data}/data/{entry.path}", entry.data) for entry in of.shared]
    entries.append(Entry(f"{info}/METADATA", metadata().encode()))
    entries.append(Entry(f"{info}/WHEEL", about.encode()))
    for file in product.project()["license-files"]:
        entries.append(Entry(f"{info}/licenses/{file}", (ROOT / file).read_bytes()))
    entries.sort(key=lambda entry: entry.path)
    entries.append(Entry(f"{info}/RECORD", _record(entries, f"{info}/RECORD").encode()))
    return f"{name}-{tag}.whl", zipped(entries, of.epoch, level)


def _record(entries: list[Entry], own: str) -> str:
    lines = []
    for entry in entries:
        digest = base64.urlsafe_b64encode(hashlib.sha256(entry.data).digest()).rstrip(b"=").decode()
        lines.append(f"{entry.path},sha256={digest},{len(entry.data)}\n")
    return "".join(lines) + f"{own},,\n"


def metadata() -> str:
    """The core metadata of the Python distribution."""
    said = product.project()
    lines = ["Metadata-Version: 2.4", f"Name: {said['name']}", f"Version: {said['version']}",
             f"Summary: {said['description']}", f"Keywords: {','.join(said['keywords'])}"]
    lines += [f"Classifier: {each}" for each in said["classifiers"]]
    lines += [f"License-Expression: {said['license']}"]
    lines += [f"License-File: {file}" for file in said["license-files"]]
    lines += [f"Requires-Python: {said['requires-python']}"]
    for extra, needed in said["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f"Requires-Dist: {each}; extra == '{extra}'" for each in needed]
    lines += ["Description-Content-Type: text/markdown", "", (ROOT / said["readme"]).read_text(encoding="utf-8")]
    return "\n".join(lines)


def tarball(of: Product) -> tuple[str, bytes]:
    """To be unpacked into a prefix, as in `/usr/local`; a zip for Windows."""
    name = f"onescan-{of.version}"
    if of.needs.system == "windows":
        entries = [Entry(f"{name}/{of.file_name}", of.program, True)]
        entries += [Entry(f"{name}/{entry.path}", entry.data) for entry in product.documents()]
        return f"{name}-windows-{of.needs.machine}.zip", zipped(entries, of.epoch, 9)
    entries = [Entry(f"{name}/bin/onescan", of.program, True)]
    entries += [Entry(f"{name}/{entry.path}", entry.data) for entry in of.shared]
    entries += [Entry(f"{name}/share/doc/onescan/{entry.path}", entry.data) for entry in product.documents()]
    libc = "-static" if of.needs.is_static else ""
    return f"{name}-linux-{of.needs.machine}{libc}.tar.gz", gzipped(tarred(entries, of.epoch))


def debian(of: Product) -> tuple[str, bytes]:
    """A package for Debian and what comes from it."""
    if of.needs.system != "linux":
        raise NotReady("a Debian package holds a program for Linux")
    entries = [Entry("usr/bin/onescan", of.program, True)]
    for entry in of.shared:
        path = entry.path.replace("share/zsh/site-functions", "share/zsh/vendor-completions")
        is_page = path.startswith("share/man/")
        entries.append(Entry(f"usr/{path}.gz" if is_page else f"usr/{path}", gzipped(entry.data) if is_page else entry.data))
    entries += [Entry(f"usr/lib/python3/dist-packages/{entry.path}", entry.data) for entry in of.client]
    for entry in product.documents():
        at = "changelog.gz" if entry.path == "CHANGELOG.md" else entry.path
        entries.append(Entry(f"usr/share/doc/onescan/{at}", gzipped(entry.data) if at.endswith(".gz") else entry.data))
    entries.append(Entry("usr/share/doc/onescan/copyright", _copyright().encode()))
    machine = DEBIAN_MACHINES[of.needs.machine]
    sums = "".join(f"{hashlib.md5(entry.data, usedforsecurity=False).hexdigest()}  {entry.path}\n"
                   for entry in sorted(entries, key=lambda entry: entry.path))
    control = [Entry("./control", _control(of, machine, entries).encode()), Entry("./md5sums", sums.encode())]
    files = [Entry(f"./{entry.path}", entry.data, entry.is_program) for entry in entries]
    members = [("debian-binary", b"2.0\n"), ("control.tar.gz", gzipped(tarred(control, of.epoch))),
               ("data.tar.gz", gzipped(tarred(files, of.epoch, folders=True)))]
    return f"onescan_{of.version}_{machine}.deb", ar(members, of.epoch)


def _control(of: Product, machine: str, entries: list[Entry]) -> str:
    libraries = "" if of.needs.is_static else f"Depends: libc6 (>= 2.{of.needs.glibc}), libgcc-s1\n"
    kib = sum(-(-len(entry.data) // 1024) for entry in entries)
    return (f"Package: onescan\nVersion: {of.version}\nArchitecture: {machine}\nSection: science\nPriority: optional\n"
            f"Maintainer: The maintainers of onescan <maintainers@onescan.invalid>\nInstalled-Size: {kib}\n{libraries}"
            f"Recommends: python3\nDescription: deterministic lockstep virtual commissioning\n"
            f" {product.project()['description']}.\n")


def _copyright() -> str:
    return ("Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\nUpstream-Name: onescan\n\n"
            "Files: *\nCopyright: the authors of onescan\nLicense: MIT or Apache-2.0\n"
            " Both texts are beside this file: LICENSE-MIT, LICENSE-APACHE.\n"
            " LICENCES-page.md has the terms of what the page consists of.\n")


def sdist(epoch_s: int) -> tuple[str, bytes]:
    """All sources with the page that Node built, so that a build needs Rust alone."""
    page = sorted((ROOT / "web/dist").glob("*"))
    if not any(path.name == "index.html" for path in page):
        raise NotReady("web/dist has no page: run `npm ci && npm run build` in `web`")
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], capture_output=True, check=True).stdout
    files = [ROOT / path for path in listed.decode().split("\0") if path]
    name = f"onescan-{product.project()['version']}"
    entries = [Entry(f"{name}/PKG-INFO", metadata().encode())]
    for path in [*files, *page]:
        if path.is_file():
            entries.append(_source(name, path))
    return f"{name}.tar.gz", gzipped(tarred(entries, epoch_s))


def _source(name: str, path: Path) -> Entry:
    is_program = bool(path.stat().st_mode & 0o100)
    return Entry(f"{name}/{path.relative_to(ROOT).as_posix()}", path.read_bytes(), is_program)
