"""The rules that each ecosystem sets for an archive and its manifest: manifests.py FOLDER, a sentence a fault.

SCHEMAS=DIR in the environment: a folder with JSON schemas as their projects publish them: etc/schemas of arduino-lint,
platformio/assets/schema of platformio-core, and what `compote manifest schema` prints, as idf_component.json.
"""

import json
import os
import pathlib
import re
import sys
import tarfile
import zipfile

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
VERSION = re.search(r"^project\(thimble VERSION (\S+) ", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)
LINK = object()  # stands for the bytes of what is no plain file
# The archive's one folder ("" for none), and what stands in it besides LICENSE, README.md and the code.
ARCHIVES = {
    f"thimble-arduino-{VERSION}.zip": ("thimble", ["library.properties", "src/thimble.h"]),
    f"thimble-platformio-{VERSION}.tar.gz": ("", ["library.json"]),
    f"thimble-esp-idf-{VERSION}.tar.gz": ("thimble", ["idf_component.yml", "CMakeLists.txt"]),
    f"thimble-zephyr-{VERSION}.tar.gz": ("thimble", ["zephyr/module.yml"]),
    f"thimble-{VERSION}.tar.gz": (f"thimble-{VERSION}", ["CMakeLists.txt", "meson.build"]),
    f"thimble-pair-{VERSION}.zip": ("thimble", ["thimble.h", "thimble.cpp"]),
    f"thimble_voxels-{VERSION}.tar.gz": (f"thimble_voxels-{VERSION}", ["setup.py", "pyproject.toml", "PKG-INFO"]),
}
SEMVER = re.compile(r"(0|[1-9]\d*)\.(0|[1-9]\d*)\.(0|[1-9]\d*)(-[0-9A-Za-z.-]+)?(\+[0-9A-Za-z.-]+)?")
# What arduino.cc's specification of libraries lists.
ARDUINO_CATEGORIES = {"Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing",
                      "Data Storage", "Data Processing", "Other", "Uncategorized"}
ARDUINO_FIELDS = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures",
                  "depends", "includes", "dot_a_linkage", "precompiled", "ldflags"}
PLATFORMIO_FIELDS = {"name", "version", "description", "keywords", "homepage", "repository", "authors", "license",
                     "frameworks", "platforms", "headers", "examples", "dependencies", "export", "scripts", "build"}
IDF_FIELDS = {"version", "targets", "description", "url", "repository", "documentation", "issues", "discussion",
              "maintainers", "dependencies", "tags", "files", "examples", "license"}


def load(folder):
    """Every archive as its files, by name."""
    loaded = {}
    for name in ARCHIVES:
        path = pathlib.Path(folder) / name
        if not path.exists():
            continue
        files = {}
        if path.suffix == ".zip":
            with zipfile.ZipFile(path) as archive:
                for entry in archive.infolist():
                    plain = entry.external_attr >> 16 & 0o170000 == 0o100000
                    files[entry.filename] = archive.read(entry) if plain else LINK
        else:
            with tarfile.open(path) as archive:
                for entry in archive:
                    files[entry.name] = archive.extractfile(entry).read() if entry.isreg() else LINK
        loaded[name] = files
    return loaded


def check_all(loaded):
    """Sentences, one a fault."""
    for name, (folder, wanted) in ARCHIVES.items():
        if name not in loaded:
            yield f"{name} was not made"
            continue
        prefix = folder + "/" if folder else ""
        inside = {}
        for file, data in loaded[name].items():
            parts = file.split("/")
            if data is LINK:
                yield f"{name}: {file} is no plain file"
            elif file.startswith("/") or ".." in parts or "" in parts:
                yield f"{name}: {file} leads out of its folder"
            elif not file.startswith(prefix):
                yield f"{name}: {file} lies outside {folder}"
            elif not re.fullmatch(r"[A-Za-z0-9_./-]+", file) or len(file) > 150 or any(part.startswith(".") for part in parts):
                yield f"{name}: {file} is a name that some system does not take"
            else:
                inside[file[len(prefix):]] = data
        lower = [file.lower() for file in inside]
        if len(set(lower)) != len(lower):
            yield f"{name}: two files differ by case only"
        for file in wanted + ["LICENSE", "README.md"]:
            if not inside.get(file):
                yield f"{name}: there is no {file}"
        if f"Thimble {VERSION}".encode() not in inside.get("README.md", b""):
            yield f"{name}: README.md does not say Thimble {VERSION}"
        if inside.get("LICENSE") != (ROOT / "LICENSE").read_bytes():
            yield f"{name}: LICENSE is not that of the tree"
        for word in (b"@VERSION@", b"@URL@", b"@CONTACT@", str(ROOT).encode()):
            for file, data in inside.items():
                if word in data and not file.endswith((".cmake", ".in")):  # which CMake fills in
                    yield f"{name}: {file} says {word.decode()}"
        for check in (complete, arduino, platformio, idf):
            yield from (f"{name}: {fault}" for fault in check(name, inside))
        if "meson.build" in inside and f"version: '{VERSION}'".encode() not in inside["meson.build"]:
            yield f"{name}: meson.build does not say version: '{VERSION}'"
        if "thimble.h" in inside and f"Thimble {VERSION}".encode() not in inside["thimble.h"]:
            yield f"{name}: thimble.h does not say Thimble {VERSION}"


def tree_files(folder, endings):
    return sorted(path for path in (ROOT / folder).rglob("*") if path.is_file() and path.suffix in endings)


def complete(name, inside):
    """All of the core is in it, and every include in quotes is found from where it stands."""
    if "-pair-" in name:
        text = inside.get("thimble.h", b"") + inside.get("thimble.cpp", b"")
        for path in tree_files("include", {".h"}) + tree_files("src", {".h", ".cpp", ".inc"}):
            there = f"// ---- {path.relative_to(ROOT)}\n".encode() in text
            if path.parent.name == "drivers":
                there = f"drivers/{path.name}" in inside and not there
            elif path.name.endswith("_c.h"):
                there = path.name in inside
            if not there:
                yield f"{path.relative_to(ROOT)} is missing"
        return
    is_arduino = "-arduino-" in name
    for path in tree_files("include", {".h"}):
        place = path.relative_to(ROOT / "include")
        if (f"src/{place}" if is_arduino else f"include/{place}") not in inside:
            yield f"include/{place} is missing"
    for path in tree_files("src", {".h", ".cpp", ".inc"}):
        place = path.relative_to(ROOT / "src")
        if (f"src/core/{place}" if is_arduino else f"src/{place}") not in inside:
            yield f"src/{place} is missing"
    for file, data in inside.items():
        if not file.startswith(("src/", "include/")) or not file.endswith((".h", ".cpp", ".inc")):
            continue
        for path in re.findall(rb'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', data, re.MULTILINE):
            near = os.path.normpath(os.path.join(os.path.dirname(file), path.decode()))
            if near not in inside and (is_arduino or f"include/{path.decode()}" not in inside):
                yield f'{file} includes "{path.decode()}", which is not there'


def properties(data):
    return dict(line.split("=", 1) for line in data.decode().splitlines() if line and not line.startswith("#"))


def arduino(_, inside):
    if "library.properties" not in inside:
        return
    try:
        said = properties(inside["library.properties"])
    except ValueError:
        yield "library.properties has a line that is not FIELD=VALUE"
        return
    for field in ("name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures"):
        if not said.get(field):
            yield f"library.properties says no {field}"
            said.setdefault(field, "")
    for field in set(said) - ARDUINO_FIELDS:
        yield f"library.properties: Arduino knows no {field}"
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 _.-]{0,62}", said["name"]) or said["name"].lower().startswith("arduino"):
        yield f"library.properties: the name {said['name']} is none"
    if said["version"] != VERSION or not SEMVER.fullmatch(said["version"]):
        yield f"library.properties says version {said['version']}, not {VERSION}"
    if said["category"] not in ARDUINO_CATEGORIES:
        yield f"library.properties: Arduino knows no category {said['category']}"
    if not re.match(r"https?://", said["url"]):
        yield f"library.properties: the url {said['url']} is none"
    if said["paragraph"].startswith(said["sentence"]):
        yield "library.properties: the paragraph says the sentence again"
    for header in said.get("includes", "").split(","):
        if f"src/{header}" not in inside:
            yield f"library.properties: src/{header} is not there"
    for file in inside:
        top = file.split("/")[0]
        if "/" not in file and file not in ("library.properties", "LICENSE", "README.md", "keywords.txt"):
            yield f"{file} stands where Arduino expects none"
        if "/" in file and top not in ("src", "examples", "extras", "docs"):
            yield f"the folder {top} is none of Arduino's"
    examples = {file.split("/")[1] for file in inside if file.startswith("examples/")}
    for example in examples:
        if f"examples/{example}/{example}.ino" not in inside:
            yield f"examples/{example} has no {example}.ino"
    if not examples:
        yield "there is no example"


def platformio(_, inside):
    if "library.json" not in inside:
        return
    try:
        said = json.loads(inside["library.json"])
    except ValueError as why:
        yield f"library.json is no JSON: {why}"
        return
    for field in set(said) - PLATFORMIO_FIELDS:
        yield f"library.json: PlatformIO knows no {field}"
    if not re.fullmatch(r"[^:;/,@<>]{1,100}", said.get("name", "")):
        yield f"library.json: the name {said.get('name')} is none"
    if said.get("version") != VERSION:
        yield f"library.json says version {said.get('version')}, not {VERSION}"
    if any(not re.fullmatch(r"[a-z0-9 _.-]{1,50}", word) for word in said.get("keywords", [])):
        yield "library.json: a keyword is none"
    if len(said.get("description", "")) > 255 or not said.get("description"):
        yield "library.json: the description is empty or has more than 255 characters"
    for field in ("srcDir", "includeDir"):
        folder = said.get("build", {}).get(field, "")
        if not any(file.startswith(folder + "/") for file in inside):
            yield f"library.json: the {field} {folder} is not there"
    for header in [said["headers"]] if isinstance(said.get("headers"), str) else said.get("headers", []):
        if f"include/{header}" not in inside:
            yield f"library.json: include/{header} is not there"


def idf(_, inside):
    if "idf_component.yml" not in inside:
        return
    said = yaml.safe_load(inside["idf_component.yml"])
    for field in set(said) - IDF_FIELDS:
        yield f"idf_component.yml: ESP-IDF knows no {field}"
    if said.get("version") != VERSION:
        yield f"idf_component.yml says version {said.get('version')}, not {VERSION}"
    if not said.get("description") or not said.get("license"):
        yield "idf_component.yml says no description or no license"
    if not re.fullmatch(r"[<>=~^]*\d+(\.\d+)*", str(said.get("dependencies", {}).get("idf", ""))):
        yield "idf_component.yml does not say which ESP-IDF it needs"
    if "if(ESP_PLATFORM)" not in inside.get("CMakeLists.txt", b"").decode().split("project(")[0]:
        yield "CMakeLists.txt does not ask for ESP_PLATFORM before project()"


def root_faults():
    """The manifests of the root say the version of CMakeLists.txt: they are what installing by address reads."""
    said = {
        "library.json": json.loads((ROOT / "library.json").read_text())["version"],
        "idf_component.yml": yaml.safe_load((ROOT / "idf_component.yml").read_text())["version"],
        "meson.build": re.search(r"version: '([^']*)'", (ROOT / "meson.build").read_text()).group(1),
    }
    for name, version in said.items():
        if version != VERSION:
            yield f"{name} says version {version}; CMakeLists.txt says {VERSION}"


def modern(schema):
    """The schema with lists in `required`: PlatformIO's says true or false in what is required, as drafts of old did."""
    if isinstance(schema, list):
        return [modern(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    parts = {key: modern(part) for key, part in schema.items()}
    said = schema.get("properties")
    if isinstance(said, dict):
        wanted = [name for name, part in said.items() if isinstance(part, dict) and part.get("required") is True]
        if wanted:
            listed = parts.get("required") if isinstance(parts.get("required"), list) else []
            parts["required"] = listed + wanted
    if "required" in parts and not isinstance(parts["required"], (list, dict)):
        del parts["required"]
    return parts


# What the name, the title or the address of a manifest's schema says, and what they do not.
SCHEMA_OF = {"library.properties": (r"library[.-]properties", r"definitions"), "library.json": (r"library\.json", r"arduino"),
             "idf_component.yml": (r"idf[_-]component", r"definitions")}


def by_schemas(folder, loaded):
    """Holds the manifests to published schemas; says which it lacks."""
    import jsonschema

    paths = sorted(pathlib.Path(folder).rglob("*.json"))
    schemas = {path.relative_to(folder).as_posix(): modern(json.loads(path.read_text())) for path in paths}
    # A schema names another by its file, as from its own address, whatever address that one gives itself.
    bases = {""} | {schema["$id"].rpartition("/")[0] + "/" for schema in schemas.values() if "$id" in schema}
    store = {base + name.split("/")[-1]: schema for base in bases for name, schema in schemas.items()}
    manifests = {
        "library.properties": properties(loaded[f"thimble-arduino-{VERSION}.zip"]["thimble/library.properties"]),
        "library.json": json.loads(loaded[f"thimble-platformio-{VERSION}.tar.gz"]["library.json"]),
        "idf_component.yml": yaml.safe_load(loaded[f"thimble-esp-idf-{VERSION}.tar.gz"]["thimble/idf_component.yml"]),
    }
    for name, said in manifests.items():
        wanted, other = SCHEMA_OF[name]
        words = {key: f"{key} {schema.get('title', '')} {schema.get('$id', '')}" for key, schema in schemas.items()}
        found = [key for key, text in words.items() if re.search(wanted, text) and not re.search(other, key)]
        if not found:
            print(f"manifests: skipped: {folder} has no schema of {name}")
        for key in found:
            resolver = jsonschema.RefResolver("", schemas[key], store=store)
            kind = jsonschema.validators.validator_for(schemas[key])
            for fault in kind(schemas[key], resolver=resolver).iter_errors(said):
                yield f"{name} against {key}: {fault.message}"


def main():
    loaded = load(sys.argv[1])
    faults = list(check_all(loaded)) + list(root_faults())
    if os.environ.get("SCHEMAS"):
        faults += by_schemas(os.environ["SCHEMAS"], loaded)
    else:
        print("manifests: skipped: published schemas (SCHEMAS=DIR names a folder with them)")
    for fault in faults:
        print(f"manifests: {fault}", file=sys.stderr)
    if not faults:
        print(f"manifests: {len(loaded)} archives and 3 manifests of the root say {VERSION} and keep their ecosystems' rules")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
