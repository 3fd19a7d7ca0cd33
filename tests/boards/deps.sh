#!/bin/sh
# Says what the tests of the boards need before anything is fetched, then installs what is missing.
set -eu
cd "$(dirname "$0")/../.."
packages=$(awk '$1 == "boards" { printf " %s", $2 }' .ci/packages)
echo "test-boards: uses cross compilers and emulators:$packages"
echo "test-boards: those that are missing are installed by apt-get, with what they need: at most 260 MB to fetch, 1.5 GB on disk"
exec .ci/deps build tools boards
