"""The source archive for Python's pip: what the module is compiled of, and its tests."""

import tree

# What CMake looks at for the module, and what it compiles.
FOLDERS = ["include", "src", "platform", "tools", "tests/reference", "tests/portable", "tests/golden", "tests/boards/apps",
           "tests/python"]
LEFT_OUT = ("platform/examples/", "platform/web/", "tools/packages/", "tools/web/")
ENDINGS = {".h", ".cpp", ".inc", ".bin", ".in", ".cmake", ".txt", ".comp", ".py", ".pyi", ".typed", ".scene", ".vox", ".gz"}


def files(_):
    names = [name for folder in FOLDERS for name in tree.walk(folder, ENDINGS) if not name.startswith(LEFT_OUT)]
    made = {name: tree.read(name) for name in [*names, "CMakeLists.txt", "LICENSE"]}
    made.update({name: tree.read(f"tools/python/{name}") for name in ("README.md", "setup.py", "pyproject.toml")})
    made["PKG-INFO"] = tree.filled("python/PKG-INFO")
    return {"thimble_voxels-{version}.tar.gz": tree.below(f"thimble_voxels-{tree.version()}", made)}
