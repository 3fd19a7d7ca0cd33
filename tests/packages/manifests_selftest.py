"""Shows the rules of manifests.py archives with one fault each; every one must be named: manifests_selftest.py FOLDER"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import manifests  # noqa: E402
from manifests import LINK, VERSION  # noqa: E402

ARDUINO = f"thimble-arduino-{VERSION}.zip"
PLATFORMIO = f"thimble-platformio-{VERSION}.tar.gz"
IDF = f"thimble-esp-idf-{VERSION}.tar.gz"
ZEPHYR = f"thimble-zephyr-{VERSION}.tar.gz"
PAIR = f"thimble-pair-{VERSION}.zip"
SOURCE = f"thimble-{VERSION}.tar.gz"


def put(name, file, data):
    return lambda loaded: loaded[name].__setitem__(file, data)


def drop(name, file):
    return lambda loaded: loaded[name].pop(file)


def swap(name, file, old, new):
    def change(loaded):
        data = loaded[name][file]
        assert old in data, f"{file} of {name} does not say {old}"
        loaded[name][file] = data.replace(old, new)

    return change


PROPERTIES = "thimble/library.properties"
version = VERSION.encode()
# Where each archive has headers and sources of drivers.
DRIVERS = {ARDUINO: ("thimble/src/thimble", "thimble/src/core"), PLATFORMIO: ("include/thimble", "src"),
           IDF: ("thimble/include/thimble", "thimble/src"), ZEPHYR: ("thimble/include/thimble", "thimble/src"),
           SOURCE: (f"thimble-{VERSION}/include/thimble", f"thimble-{VERSION}/src"), PAIR: ("thimble", "thimble")}
CASES = [
    ("was not made", lambda loaded: loaded.pop(PAIR)),
    ("no plain file", put(ARDUINO, "thimble/src/link.h", LINK)),
    ("leads out", put(SOURCE, f"thimble-{VERSION}/../evil.h", b"")),
    ("lies outside", put(IDF, "other/file.h", b"")),
    ("some system does not take", put(IDF, "thimble/a:b.h", b"")),
    ("differ by case", put(PLATFORMIO, "license", b"")),
    ("there is no LICENSE", drop(PLATFORMIO, "LICENSE")),
    ("does not say Thimble", swap(PLATFORMIO, "README.md", version, b"9.9.9")),
    ("not that of the tree", put(PAIR, "thimble/LICENSE", b"none")),
    ("says @VERSION@", put(PAIR, "thimble/extra.txt", b"@VERSION@")),
    ("include/thimble/base/vec.h is missing", drop(PLATFORMIO, "include/thimble/base/vec.h")),
    ("src/base/bits.h is missing", drop(ARDUINO, "thimble/src/core/base/bits.h")),
    *(("drivers/panel.h is missing", drop(name, f"{at[0]}/drivers/panel.h")) for name, at in DRIVERS.items()),
    *(("drivers/page_panel.cpp is missing", drop(name, f"{at[1]}/drivers/page_panel.cpp")) for name, at in DRIVERS.items()),
    ("src/drivers/color_panel.cpp is missing", swap(PAIR, "thimble/thimble.cpp", b"// ---- src/base/crc32.cpp\n",
                                                    b"// ---- src/base/crc32.cpp\n// ---- src/drivers/color_panel.cpp\n")),
    ("which is not there", put(ARDUINO, "thimble/src/core/base/more.cpp", b'#include "thimble/base/vec.h"\n')),
    ("include/thimble/base/vec.h is missing", swap(PAIR, "thimble/thimble.h", b"// ---- include/thimble/base/vec.h", b"//")),
    ("not FIELD=VALUE", put(ARDUINO, PROPERTIES, b"name\n")),
    ("says no url", swap(ARDUINO, PROPERTIES, b"url=", b"#url=")),
    ("Arduino knows no license", swap(ARDUINO, PROPERTIES, b"url=", b"license=MIT\nurl=")),
    ("is none", swap(ARDUINO, PROPERTIES, b"name=thimble", b"name=a:b")),
    ("says version 1.x", swap(ARDUINO, PROPERTIES, b"version=" + version, b"version=1.x")),
    ("no category Voxels", swap(ARDUINO, PROPERTIES, b"=Display", b"=Voxels")),
    ("src/other.h is not there", swap(ARDUINO, PROPERTIES, b"includes=thimble.h", b"includes=other.h")),
    ("expects none", put(ARDUINO, "thimble/thimble.h", b"")),
    ("none of Arduino's", put(ARDUINO, "thimble/include/a.h", b"")),
    ("has no Empty.ino", put(ARDUINO, "thimble/examples/Empty/scene.h", b"")),
    ("is no JSON", put(PLATFORMIO, "library.json", b"{")),
    ("PlatformIO knows no sources", swap(PLATFORMIO, "library.json", b'"name"', b'"sources": 1, "name"')),
    ("library.json says version 9", swap(PLATFORMIO, "library.json", version, b"9.9.9")),
    ("the srcDir sources is not there", swap(PLATFORMIO, "library.json", b'"srcDir": "src"', b'"srcDir": "sources"')),
    ("include/none.h is not there", swap(PLATFORMIO, "library.json", b"thimble/thimble.h", b"none.h")),
    ("idf_component.yml says version 9", swap(IDF, "thimble/idf_component.yml", version, b"9.9.9")),
    ("which ESP-IDF", swap(IDF, "thimble/idf_component.yml", b">=5.0", b"any")),
    ("before project()", swap(IDF, "thimble/CMakeLists.txt", b"if(ESP_PLATFORM)", b"if(OTHER)")),
    ("meson.build does not say", swap(SOURCE, f"thimble-{VERSION}/meson.build", version, b"9.9.9")),
    ("thimble.h does not say", swap(PAIR, "thimble/thimble.h", b"Thimble " + version, b"Thimble")),
]


# Schemas of ours in the forms of those that are published (SCHEMAS=DIR): what one of them refuses, and the change.
SCHEMAS = pathlib.Path(__file__).resolve().parent / "schemas"
BY_SCHEMA = [
    ("library.properties against", "'1.x' does not match", swap(ARDUINO, PROPERTIES, b"version=" + version, b"version=1.x")),
    ("library.properties against", "'category' is a required", swap(ARDUINO, PROPERTIES, b"category=", b"#category=")),
    ("library.json against", "'name' is a required", swap(PLATFORMIO, "library.json", b'"name": "thimble",', b"")),
    ("library.json against", "is too long", swap(PLATFORMIO, "library.json", b'"thimble"', b'"' + b"x" * 51 + b'"')),
    ("idf_component.yml against", "'sources' was unexpected", put(IDF, "thimble/idf_component.yml", b"sources: none\n")),
]


def by_schemas(sound):
    """Sentences where the schemas take what they should not, or the other way round."""
    faults = list(manifests.by_schemas(SCHEMAS, sound))
    if faults:
        yield f"sound manifests are refused: {faults}"
    for name, wanted, change in BY_SCHEMA:
        loaded = {archive: dict(files) for archive, files in sound.items()}
        change(loaded)
        faults = list(manifests.by_schemas(SCHEMAS, loaded))
        if not any(fault.startswith(name) and wanted in fault for fault in faults):
            yield f'no schema says "{name} ... {wanted}", but: {faults}'


def release():
    """A release with the places that are none is refused, in a sentence, and makes nothing."""
    with tempfile.TemporaryDirectory() as folder:
        make = manifests.ROOT / "tools/packages/make.py"
        told = subprocess.run([sys.executable, "-B", make, "--release", "--out", f"{folder}/out"], capture_output=True, text=True)
        tree = (manifests.ROOT / "tools/packages/tree.py").read_text()
        names = [name for name in ("URL", "CONTACT") if re.search(rf'^{name} = .*\.invalid', tree, re.MULTILINE)]
        if names and (told.returncode != 1 or os.path.exists(f"{folder}/out") or not told.stderr.startswith("packages: a release")
                      or not all(name in told.stderr for name in names)):
            yield f"a release that names no place ends with {told.returncode}: {told.stderr}"


def main():
    sound = manifests.load(sys.argv[1])
    failed = 0
    for fault in [*by_schemas(sound), *release()]:
        print(f"manifests_selftest: {fault}", file=sys.stderr)
        failed = 1
    for wanted, change in CASES:
        loaded = {name: dict(files) for name, files in sound.items()}
        change(loaded)
        faults = list(manifests.check_all(loaded))
        if not any(wanted in fault for fault in faults):
            print(f'manifests_selftest: nothing says "{wanted}", but: {faults}', file=sys.stderr)
            failed = 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
