"""Prints what of src is compiled, a line each: meson.build asks, since Meson looks for no files itself."""

import pathlib

root = pathlib.Path(__file__).resolve().parent.parent.parent
for path in sorted((root / "src").rglob("*")):
    if path.suffix == ".cpp":
        print(path.relative_to(root).as_posix())
