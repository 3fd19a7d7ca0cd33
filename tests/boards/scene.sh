#!/bin/sh
# The scene that the tests give a board: scene.sh BOARD prints what `thimble bake` takes.
set -eu
echo demo
