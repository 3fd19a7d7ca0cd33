#!/bin/sh
# Who may include whom. layering.sh ROOT
#   include/thimble  <stdint.h>, <stddef.h>, "thimble/..."
#   src              those, and headers that lie in src
#   tools, platform  no header of src
#   platform         nothing of the tests but "portable/..." in the applications that run them on boards
#   tests/portable   what a board has: <stdint.h>, <stddef.h>, "thimble/..." and themselves; so do the golden scenes
#   tests/reference  nothing of the product: neither the core's nor the tools' headers
set -eu
cd "$1"
failed=0
# complain SENTENCE LINES: reports LINES unless there are none.
complain() {
  if [ -n "$2" ]; then
    echo "$2"
    echo "layering: $1" >&2
    failed=1
  fi
}
includes() {
  for folder in "$@"; do
    if [ -d "$folder" ]; then
      find "$folder" \( -name '*.h' -o -name '*.cpp' \) -exec grep -HnE '^[[:space:]]*#[[:space:]]*(include|import)' {} + || true
    fi
  done
}
core='#[[:space:]]*include[[:space:]]*(<stdint\.h>|<stddef\.h>|"thimble/[a-z0-9_]+\.h")'
complain "a public header includes more than <stdint.h>, <stddef.h> and \"thimble/...\"" \
  "$(includes include | grep -vE "$core" || true)"
own=
for header in src/*.h; do
  [ -e "$header" ] && own="$own|$(basename "$header" .h)"
done
complain "src includes more than the public headers, its own and <stdint.h>, <stddef.h>" \
  "$(includes src | grep -vE "$core|#[[:space:]]*include[[:space:]]*\"(src/)?(${own#|})\\.h\"" || true)"
complain "tools and platform see public headers only, never src" \
  "$(includes tools platform | grep -E '["/]src/' || true)"
for name in $(echo "$own" | tr '|' ' '); do
  # The same name may exist on both sides; then it is the includer's own.
  if [ -z "$(find tools platform -name "$name.h" 2>/dev/null)" ]; then
    complain "tools and platform see public headers only, never src/$name.h" \
      "$(includes tools platform | grep -E "[\"/]$name\\.h\"" || true)"
  fi
done
tests_on_boards='^platform/apps/(selftest|golden|lit|cases)\.(cpp|h):'
complain "platform sees no test; only the applications selftest, golden and lit run those of tests/portable" \
  "$({
    includes platform | grep -E '["/](golden|portable|support|reference|tests)/' | grep -vE "$tests_on_boards"
    includes platform | grep -E "$tests_on_boards" | grep -E '["/](golden|support|reference|tests)/'
  } || true)"
board='#[[:space:]]*include[[:space:]]*(<stdint\.h>|<stddef\.h>|"(thimble|portable|golden)/[a-z0-9_]+\.(h|inc)")'
complain "the cases that run on boards include more than <stdint.h>, <stddef.h>, \"thimble/...\" and one another" \
  "$(includes tests/portable tests/golden | grep -v '^tests/golden/main\.cpp:' | grep -vE "$board" || true)"
complain "the reference shares no code with the product" \
  "$(includes tests/reference | grep -E '["</](thimble|src|tools|readers|scene|platform)/' || true)"
exit $failed
