"""What every package is made of: the core as it stands in include and src, the licence, the version."""

import pathlib
import posixpath
import re

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
HERE = pathlib.Path(__file__).resolve().parent
# Whom a manifest names, until the project has a place on the net.
URL = "https://thimble.invalid"
CONTACT = "Thimble <thimble@thimble.invalid>"  # tools/install.cmake reads it, too

_INCLUDE = re.compile(rb'^([ \t]*#[ \t]*include[ \t]*)"([^"]+)"', re.MULTILINE)


def stand_ins():
    """Which of these name no place; `.invalid` is nobody's."""
    return [name for name in ("URL", "CONTACT") if ".invalid" in globals()[name]]


def version():
    """The one place that says it."""
    said = re.search(r"^project\(thimble VERSION ([0-9]+\.[0-9]+\.[0-9]+) ", read("CMakeLists.txt").decode(), re.MULTILINE)
    if said is None:
        raise SystemExit("packages: CMakeLists.txt says no version in project(thimble VERSION ...)")
    return said.group(1)


def read(name):
    return (ROOT / name).read_bytes()


def walk(folder, endings):
    """The files below a folder that end so, as names below the root; compiled Python aside."""
    for path in sorted((ROOT / folder).rglob("*")):
        if path.is_symlink():
            raise SystemExit(f"packages: {path.relative_to(ROOT)} is a link; no package may hold one")
        if path.is_file() and path.suffix in endings:
            yield path.relative_to(ROOT).as_posix()


def headers():
    """The public headers, as names below the root."""
    return list(walk("include", {".h"}))


def sources():
    """All of src: what is compiled, and the headers that it keeps to itself."""
    return list(walk("src", {".cpp", ".h", ".inc"}))


def core():
    """Headers and sources where they stand in the tree, by name."""
    return {name: read(name) for name in headers() + sources()}


def common(ecosystem):
    """What each package has beside its code: the licence, its own README with the version."""
    return {"LICENSE": read("LICENSE"), "README.md": filled(f"{ecosystem}/README.md")}


def filled(name):
    """A file of tools/packages with @VERSION@, @URL@ and @CONTACT@ said."""
    text = (HERE / name).read_text()
    for word, meaning in (("@VERSION@", version()), ("@URL@", URL), ("@CONTACT@", CONTACT)):
        text = text.replace(word, meaning)
    return text.encode()


def below(folder, files):
    return {posixpath.join(folder, name): data for name, data in files.items()}


def each_include(data, replace):
    """Calls `replace(prefix, path)` for each include in quotes; None leaves it."""

    def one(match):
        path = replace(match.group(1), match.group(2).decode())
        return match.group(0) if path is None else path

    return _INCLUDE.sub(one, data)
