"""Archives whose bytes depend on nothing but their files: sorted, one time, no owner."""

import gzip
import io
import os
import pathlib
import subprocess
import tarfile
import time
import zipfile

_EARLIEST = 315532800  # 1980-01-01, the first day that a zip can say


def epoch(root):
    """Seconds of SOURCE_DATE_EPOCH, else of the commit; where there is neither, 1980."""
    said = os.environ.get("SOURCE_DATE_EPOCH", "")
    if not said and (pathlib.Path(root) / ".git").exists():
        log = subprocess.run(["git", "-C", str(root), "log", "-1", "--format=%ct"], capture_output=True, text=True)
        said = log.stdout.strip() if log.returncode == 0 else ""
    return max(int(said or 0), _EARLIEST)


def write_zip(path, files, seconds):
    """`files` maps names to bytes. Stored by deflate, as files that everybody may read."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, time.gmtime(seconds)[:6])
            entry.create_system = 3  # Unix, so that the mode counts
            entry.external_attr = 0o100644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, files[name])


def write_tar_gz(path, files, seconds):
    plain = io.BytesIO()
    with tarfile.open(fileobj=plain, mode="w", format=tarfile.USTAR_FORMAT) as archive:
        for name in sorted(files):
            entry = tarfile.TarInfo(name)
            entry.size = len(files[name])
            entry.mtime = seconds
            entry.mode = 0o644
            archive.addfile(entry, io.BytesIO(files[name]))
    with open(path, "wb") as out, gzip.GzipFile("", "wb", 9, out, mtime=seconds) as packed:
        packed.write(plain.getvalue())
