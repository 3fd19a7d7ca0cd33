"""Reads a module as Zephyr's zephyr_module.py and Kconfig would, and says where its parts lie: module.py FOLDER"""

import pathlib
import re
import sys

import yaml

root = pathlib.Path(sys.argv[1])
module = yaml.safe_load((root / "zephyr/module.yml").read_text())


def wrong(what):
    sys.exit(f"zephyr: zephyr/module.yml: {what}")


unknown = set(module) - {"name", "build", "samples", "tests", "boards", "security", "package-managers"}
if unknown:
    wrong(f"Zephyr knows no {sorted(unknown)[0]}")
if not re.fullmatch(r"[A-Za-z0-9_-]+", module["name"]):
    wrong(f"the name {module['name']} is none")
if not (root / module["build"]["cmake"] / "CMakeLists.txt").is_file():
    wrong(f"{module['build']['cmake']} has no CMakeLists.txt")
kconfig = root / module["build"]["kconfig"]
if not kconfig.is_file():
    wrong(f"{module['build']['kconfig']} is not there")
for sample in module["samples"]:
    for name in ("CMakeLists.txt", "prj.conf", "sample.yaml"):
        if not (root / sample / name).is_file():
            wrong(f"the sample {sample} has no {name}")
    if not yaml.safe_load((root / sample / "sample.yaml").read_text())["tests"]:
        wrong("sample.yaml names no test")

# Off until asked for, on with what the sample's prj.conf says; never without C++17.
try:
    import kconfiglib
except ImportError:
    print("echo 'zephyr: skipped: Kconfig is not read, for there is no python3-kconfiglib'")
else:
    with open(root / "Kconfig.test", "w") as out:
        out.write("config CPP\n\tbool 'C++'\nconfig DISPLAY\n\tbool 'displays'\nconfig MAIN_STACK_SIZE\n\tint 'stack'\n"
                  "choice\n\tprompt 'standard'\n\tdepends on CPP\n\tdefault STD_CPP11\nconfig STD_CPP11\n\tbool 'C++11'\n"
                  f"config STD_CPP17\n\tbool 'C++17'\nendchoice\nsource \"{kconfig}\"\n")
    tree = kconfiglib.Kconfig(str(root / "Kconfig.test"), warn=True, warn_to_stderr=True)
    if tree.syms["THIMBLE"].str_value != "n":
        wrong("THIMBLE is on by itself")
    for path in module["samples"]:
        tree.load_config(str(root / path / "prj.conf"))
        if tree.syms["THIMBLE"].str_value != "y":
            wrong(f"{path}/prj.conf does not turn THIMBLE on")
        if tree.warnings:
            wrong(tree.warnings[0])
    tree.syms["STD_CPP11"].set_value("y")
    if tree.syms["THIMBLE"].str_value != "n":
        wrong("THIMBLE is on although the language is C++11")
print(f"module_cmake={module['build']['cmake']}")
print(f"module_sample={module['samples'][0]}")
