#!/bin/sh
# Who may include whom. layering.sh ROOT
#   include/thimble  <stdint.h>, <stddef.h>, "thimble/..."
#   src              those, and headers that lie in src
#   tools, platform  no header of src
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
complain "the reference shares no code with the product" \
  "$(includes tests/reference | grep -E '["</](thimble|src|tools|readers|scene|platform)/' || true)"
exit $failed
