"""Makes the packages of every ecosystem from the tree: make.py [--out FOLDER] [--thimble COMMAND] [--release] [NAME...]

NAME is arduino, platformio, esp_idf, zephyr, source, pair or python (default: all). The .deb is tools/package.sh's.
"""

import argparse
import hashlib
import importlib
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import archive  # noqa: E402
import tree  # noqa: E402

ECOSYSTEMS = ["arduino", "platformio", "esp_idf", "zephyr", "source", "pair", "python"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=pathlib.Path, default=tree.ROOT / "build/packages")
    parser.add_argument("--thimble", default=str(tree.ROOT / "build/release/thimble"), help="bakes the examples' scene")
    parser.add_argument("--release", action="store_true", help="refuse to name a place that is none")
    parser.add_argument("names", nargs="*", metavar="NAME")
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in ECOSYSTEMS]
    if unknown:
        parser.error(f"{unknown[0]} is none of {', '.join(ECOSYSTEMS)}")
    if options.release and tree.stand_ins():
        raise SystemExit(f"packages: a release names where the project is: set {' and '.join(tree.stand_ins())} of "
                         "tools/packages/tree.py, which say thimble.invalid")
    options.out.mkdir(parents=True, exist_ok=True)
    seconds = archive.epoch(tree.ROOT)
    for name in options.names or ECOSYSTEMS:
        for pattern, files in importlib.import_module(name).files(options.thimble).items():
            path = options.out / pattern.format(version=tree.version())
            (archive.write_zip if path.suffix == ".zip" else archive.write_tar_gz)(path, files, seconds)
            print(f"package: {path} ({path.stat().st_size} bytes, {len(files)} files)")
            if name == "source":
                write_wrap(options.out / "thimble.wrap", path)


def write_wrap(wrap, path):
    """What Meson wants of a subproject that lies in subprojects/packagefiles."""
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    wrap.write_text(f"[wrap-file]\ndirectory = thimble-{tree.version()}\nsource_filename = {path.name}\n"
                    f"source_hash = {digest}\n\n[provide]\nthimble = thimble_dep\n")
    print(f"package: {wrap}")


if __name__ == "__main__":
    main()
