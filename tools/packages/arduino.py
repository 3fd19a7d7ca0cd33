"""The Arduino library: everything below src, where includes go from file to file."""

import posixpath
import subprocess
import tempfile

import tree

# What each example shows: a scene that comes along, and the size of the display.
EXAMPLES = {"SSD1306": ("castle.vox", "128x64"), "ST7789": ("fox.vox.gz", "240x240")}


def _place(name):
    """Where a file of the tree stands in the library."""
    if name.startswith("include/"):
        return "src/" + name[len("include/"):]
    return "src/core/" + name[len("src/"):]


def _relative(name, data):
    here = posixpath.dirname(_place(name))

    def to(prefix, path):
        if not path.startswith("thimble/"):
            return None
        return prefix + b'"' + posixpath.relpath(_place("include/" + path), here).encode() + b'"'

    return tree.each_include(data, to)


def _scene(thimble, scene, size):
    """The scene of an example, as `thimble bake` writes it."""
    with tempfile.TemporaryDirectory() as folder:
        out = f"{folder}/scene.h"
        subprocess.run([thimble, "bake", f"tools/gallery/scenes/{scene}", "--size", size, "--effects", "none",
                        "--brick-map", "--quiet", "-o", out], cwd=tree.ROOT, check=True)
        with open(out, "rb") as made:
            return made.read()


def files(thimble):
    made = {_place(name): _relative(name, data) for name, data in tree.core().items()}
    made["library.properties"] = tree.filled("arduino/library.properties")
    made["src/thimble.h"] = tree.filled("arduino/thimble.h")
    if "include/thimble/thimble_c.h" in tree.headers():
        made["src/thimble_c.h"] = b'// The C face.\n#include "thimble/thimble_c.h"\n'
    for example, (scene, size) in EXAMPLES.items():
        folder = f"examples/{example}"
        made[f"{folder}/{example}.ino"] = tree.filled(f"arduino/{folder}/{example}.ino")
        made[f"{folder}/scene.h"] = _scene(thimble, scene, size)
    made.update(tree.common("arduino"))
    return {"thimble-arduino-{version}.zip": tree.below("thimble", made)}
