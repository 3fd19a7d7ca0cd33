#!/bin/sh
# Judges the page that `make web` built: its modules under Node, then the page itself in headless Chromium.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/web/tests
node tests/web/test_modules.js build/web/modules build/release/thimble
node tests/web/test_page.js build/web/thimble.html build/release/thimble
