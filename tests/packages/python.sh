#!/bin/sh
# The Python package: the wheel, then the archive, each installed in an empty virtual environment (NumPy and what builds are
# the system's) without a network, where its tests and the examples pass.
name=python
. tests/packages/common.sh
$python -c 'import numpy, pybind11, setuptools, venv, pip, wheel' 2>/dev/null || {
  say "skipped: python3-numpy, pybind11, setuptools, wheel, pip or venv is missing"
  exit 0
}
WORK=$(cd "$WORK" && pwd)
packages=$(cd "$PACKAGES" && pwd)
here=$PWD
tried=
# To compile the archive takes minutes: FROM_SOURCE=yes does so, else its module is the one that is built already.
[ "${FROM_SOURCE:-}" = yes ] || export THIMBLE_BUILD="$here/build/release"
export CMAKE_BUILD_PARALLEL_LEVEL="${CMAKE_BUILD_PARALLEL_LEVEL:-2}"
for file in "$packages"/thimble_voxels-"$VERSION"-*.whl "$packages/thimble_voxels-$VERSION.tar.gz"; do
  [ -f "$file" ] || fail "$file was not made"
  venv=$WORK/venv
  rm -rf "$venv"
  logged $python -m venv --system-site-packages "$venv"
  logged "$venv/bin/python" -m pip install --no-index --no-build-isolation "$file"
  # From where no source of the tree is found.
  (cd "$venv" && logged env THIMBLE_COMMAND="$here/build/release/thimble" bin/python "$here/tests/python/test_thimble.py") || exit 1
  for example in tools/python/examples/*.py; do
    (cd "$venv" && logged env MPLBACKEND=Agg bin/python "$here/$example" castle) || exit 1
  done
  tried="$tried $(basename "$file")"
done
"$venv/bin/python" -m pydoc thimble >"$WORK/pydoc.txt" && grep -q 'class Scene' "$WORK/pydoc.txt" || fail "pydoc shows no Scene"
say "$tried: installed in an empty environment, tests and examples pass"
