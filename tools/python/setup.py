"""Builds the package from the archive that this file lies in: CMake compiles the module, with the packages of the command.

THIMBLE_BUILD names a folder in which it is built already (python/thimble in it).
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
VERSION = re.search(r"^project\(thimble VERSION (\S+) ", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE).group(1)


class CMakeModule(build_ext):
    def run(self):
        given = os.environ.get("THIMBLE_BUILD")
        folder = pathlib.Path(given or self.build_temp).resolve()
        if not given:
            subprocess.check_call([
                "cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "--log-level=WARNING", "-Wno-dev", "-DTHIMBLE_PYTHON=ON",
                "-DTHIMBLE_TESTS=OFF", "-DTHIMBLE_INSTALL=OFF", "-DTHIMBLE_WINDOW=OFF", "-DTHIMBLE_GPU=OFF",
                f"-DPython3_EXECUTABLE={sys.executable}"])
            subprocess.check_call(["cmake", "--build", folder, "--target", "thimble_python"])
        package = pathlib.Path(self.build_lib) / "thimble"
        package.mkdir(parents=True, exist_ok=True)
        for module in (folder / "python/thimble").glob("_thimble*.so"):
            shutil.copy(module, package)
            subprocess.call(["strip", "--strip-unneeded", package / module.name])
        (package / "scenes").mkdir(exist_ok=True)
        for scene in (ROOT / "tools/gallery/scenes").iterdir():
            shutil.copy(scene, package / "scenes")


setup(
    name="thimble-voxels",
    version=VERSION,
    description="An exact voxel ray tracer: voxels, points and meshes on NumPy's arrays",
    license="MIT",
    python_requires=">=3.9",
    install_requires=["numpy"],
    packages=["thimble"],
    package_dir={"thimble": "tools/python/thimble"},
    package_data={"thimble": ["*.pyi", "py.typed"]},
    ext_modules=[Extension("thimble._thimble", [])],
    cmdclass={"build_ext": CMakeModule},
    zip_safe=False,
)
