#!/bin/sh
# Judges the page that `make web` built, in headless Chromium. Its modules are tested under Node by `make test-all`.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/web/tests
node tests/web/test_page.js build/web/thimble.html build/release/thimble
node tests/web/test_gpu.js build/web/thimble.html build/release/thimble
node tests/web/test_share.js build/release/thimble
node tests/web/bench.js
