"""Archives whose bytes depend on nothing but what is in them: sorted, one time, fixed modes, no owners."""

import gzip
import io
import tarfile
import time
import zipfile
from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """A file of a package."""

    path: str
    data: bytes
    is_program: bool = False

    @property
    def mode(self) -> int:
        return 0o755 if self.is_program else 0o644


def zipped(entries: list[Entry], epoch: int, level: int) -> bytes:
    """A zip, in the order given: a wheel has its record at the end."""
    out = io.BytesIO()
    # A zip knows no time before 1980, and none in odd seconds.
    date = time.gmtime(max(epoch, 315532800))[:6]
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=level) as archive:
        for entry in entries:
            info = zipfile.ZipInfo(entry.path, date)
            info.create_system = 3
            info.external_attr = (0o100000 | entry.mode) << 16
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, entry.data)
    return out.getvalue()


def tarred(entries: list[Entry], epoch: int, folders: bool = False) -> bytes:
    """A tar, with an entry for each folder if asked for."""
    out = io.BytesIO()
    with tarfile.open(fileobj=out, mode="w", format=tarfile.PAX_FORMAT) as archive:
        made: set[str] = set()
        for entry in sorted(entries, key=lambda entry: entry.path):
            parts = entry.path.split("/")
            for depth in range(1, len(parts)) if folders else ():
                folder = "/".join(parts[:depth])
                if folder not in made:
                    made.add(folder)
                    archive.addfile(_info(folder, epoch, 0o755, tarfile.DIRTYPE))
            info = _info(entry.path, epoch, entry.mode, tarfile.REGTYPE)
            info.size = len(entry.data)
            archive.addfile(info, io.BytesIO(entry.data))
    return out.getvalue()


def _info(path: str, epoch: int, mode: int, kind: bytes) -> tarfile.TarInfo:
    info = tarfile.TarInfo(path)
    info.mtime, info.mode, info.type = epoch, mode, kind
    info.uname = info.gname = "root"
    return info


def gzipped(data: bytes, level: int = 6) -> bytes:
    """Without the name and the time that gzip keeps."""
    out = io.BytesIO()
    with gzip.GzipFile("", "wb", level, out, mtime=0) as packed:
        packed.write(data)
    return out.getvalue()


def ar(members: list[tuple[str, bytes]], epoch: int) -> bytes:
    """The outer form of a Debian package."""
    out = b"!<arch>\n"
    for name, data in members:
        out += f"{name:<16}{epoch:<12}{0:<6}{0:<6}{'100644':<8}{len(data):<10}`\n".encode()
        out += data + b"\n" * (len(data) % 2)
    return out
