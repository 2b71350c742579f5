"""The crates, packed as cargo would publish them: each has all that it is built from, the page included."""

import io
import posixpath
import re
import subprocess
import tarfile
import tomllib
from pathlib import Path

from product import ROOT, NotReady

PAGE = "dist/index.html"
INCLUDED = re.compile(r'include_(?:str|bytes)!\("([^"]+)"\)')


def published() -> list[str]:
    """The crates in an order in which each comes after those that it depends on."""
    needs = _needs()
    order: list[str] = []
    while len(order) < len(needs):
        ready = sorted(name for name, on in needs.items() if name not in order and on <= set(order))
        if not ready:
            raise NotReady(f"crates depend on each other in a circle: {', '.join(sorted(set(needs) - set(order)))}")
        order += ready
    return order


def _needs() -> dict[str, set[str]]:
    """Of each crate that is not for tests only: which others of the workspace it is built from."""
    manifests = {}
    members = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["members"]
    for member in members:
        manifest = tomllib.loads((ROOT / member / "Cargo.toml").read_text())
        if manifest["package"].get("publish", True):
            manifests[manifest["package"]["name"]] = manifest
    needs = {}
    for name, manifest in manifests.items():
        needs[name] = {key for key in manifest.get("dependencies", {}) if key.startswith("onescan")}
        if not needs[name] <= set(manifests):
            raise NotReady(f"{name} depends on {', '.join(needs[name] - set(manifests))}, which no registry gets")
    return needs


def packed(target: Path, is_built: bool = False) -> list[tuple[str, bytes]]:
    """Packs them; with `is_built` cargo builds each from what was packed, without the workspace."""
    order = published()
    chosen = [word for name in order for word in ("--package", name)]
    command = ["cargo", "package", "--locked", "--allow-dirty", *chosen]
    if is_built:
        # It is a check and no release: what is built is thrown away.
        command += ["--config", "profile.dev.package.\"*\".opt-level=0", "--config", "profile.dev.debug=false"]
    else:
        command.append("--no-verify")
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise NotReady(f"`{' '.join(command)}` ended with {done.returncode}\n{done.stderr[-4000:]}")
    version = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]
    files = []
    for name in order:
        data = (target / "package" / f"{name}-{version}.crate").read_bytes()
        files.append((f"crates/{name}-{version}.crate", data))
        if missing := _missing(data):
            raise NotReady(f"the crate {name} does not have what it is built from: {', '.join(missing)}")
        if name == "onescan-page" and f"{name}-{version}/{PAGE}" not in _names(data):
            raise NotReady("the crate of the page has no page: run `npm ci && npm run build` in `web`")
    # For who publishes them.
    files.append(("crates/ORDER", "".join(f"{name}\n" for name in order).encode()))
    return files


def _names(data: bytes) -> list[str]:
    with tarfile.open(fileobj=io.BytesIO(data), mode="r:gz") as archive:
        return archive.getnames()


def _missing(data: bytes) -> list[str]:
    """What sources include, other than for tests, and the crate does not have. It is much faster than a build."""
    found = []
    with tarfile.open(fileobj=io.BytesIO(data), mode="r:gz") as archive:
        names = set(archive.getnames())
        for member in archive.getmembers():
            if not member.name.endswith(".rs") or "tests" in Path(member.name).with_suffix("").parts:
                continue
            source = archive.extractfile(member)
            text = source.read().decode().split("#[cfg(")[0] if source else ""
            for path in INCLUDED.findall(text):
                if posixpath.normpath(posixpath.join(posixpath.dirname(member.name), path)) not in names:
                    found.append(f"{member.name}: {path}")
    return found
