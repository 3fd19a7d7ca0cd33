#!/bin/sh
# Words of the core, outside comments; and phrases that stand nowhere. words.sh ROOT
#   It uses no floating point, no heap, no exceptions, no virtual functions and no C++ library: none of their words
#   stands in include/ or src/.
#   One rule for verbs: what is static and returns a Status is called open (it looks at bytes) or make (it builds in
#   memory that is given); so end, in C, the functions that fill a handle from nothing.
#   Phrases that hide who does what stand in no page, comment or message. Pages that log what was tried (LOG.md) are free,
#   and so is what a reader tells apart, or from something.
#   On the tracing path (trace, picture) a product of 64 bits has a name, of src/base/wide_arithmetic.h: no cast to 64
#   bits stands beside a `*`, nor does a camera's step, which has 64 bits.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$1"
words='float|double|new|delete|virtual|throw|try|catch|typeid|dynamic_cast|thread_local|malloc|free'
failed=0
# complain SENTENCE LINES: reports LINES unless there are none.
complain() {
  if [ -n "$2" ]; then
    echo "$2"
    echo "words: $1" >&2
    failed=1
  fi
}
code=$(find include src \( -name '*.h' -o -name '*.cpp' \) -exec awk -f "$here/strip_comments.awk" {} +)
found=$(echo "$code" | sed 's/= *delete//g' | grep -E "^[^:]*:[0-9]+:(.*[^A-Za-z0-9_])?($words)([^A-Za-z0-9_]|\$)|^[^:]*:[0-9]+:.*std::" || true)
complain "the core must do without: $words, std::" "$found"
complain "a static function of include/ that returns a Status is called open or make" \
  "$(echo "$code" | grep -E '^include/.*[^A-Za-z0-9_]static( constexpr| inline)* Status +[a-z_0-9]+\(' |
    grep -vE ' Status +(open|make)\(' || true)"
complain "in C a handle is filled by NAME_open, NAME_make, NAME_set or by what it is part of" \
  "$(echo "$code" | grep -E '^include/thimble/thimble_c\.h:.*[^a-z0-9_]thimble_[a-z_]*_(begin|build|create|init|new)\(' || true)"
wide='(u?int64_t\{[^{}]*\}|static_cast<u?int64_t>\(([^()]|\([^()]*\))*\))'
step='(affine|course)\.step_[xy](\[[a-z]+\]|\.[xyz])'
complain "a product of 64 bits has a name of src/base/wide_arithmetic.h" \
  "$(echo "$code" | grep -E '^(src|include/thimble)/(trace|picture)/' |
    grep -E "($wide|$step) *\*|\* *($wide|$step)" || true)"
hiding='(is|are|was|were|be|been|being) (told|asked)|(goes|go|went|going) on|What .* (has|have) of|[Oo]nly who asks|Asked (was|were)'
complain "write the field's noun, a subject and a verb (CONTRIBUTING, Names and English)" \
  "$(find . \( -path ./build -o -path ./out -o -path ./.git -o -name node_modules \) -prune -o -type f ! -name LOG.md \
    -exec grep -nIEwH "$hiding" {} + | sed -E 's/told (apart|from)//g' | grep -Ew "$hiding" || true)"
exit $failed
