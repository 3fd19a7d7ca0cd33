#!/bin/sh
# What the core's objects ask of the outside, and what they leave in RAM: only undefined symbols of an allow-list
# (one name or pattern a line), no writable data, no constructors that run before main.
# symbols.sh TOOL_PREFIX ALLOW_LIST FILE... (objects or archives; the prefix `host` is none)
set -eu
prefix=${1#host}
allow=$2
shift 2
failed=0
all=$("${prefix}nm" "$@" | awk 'NF >= 2 { print $(NF - 1), $NF }')
if [ -z "$all" ]; then
  echo "symbols: no symbols at all in $*" >&2
  exit 1
fi
undefined=$(echo "$all" | awk '
  $1 == "U" || $1 == "w" || $1 == "v" { wanted[$2] = 1; next }
  { defined[$2] = 1 }
  END { for (name in wanted) { if (!(name in defined)) { print name } } }' | sort)
for name in $undefined; do
  allowed=0
  while read -r pattern; do
    case $pattern in "" | "#"*) continue ;; esac
    case $name in $pattern) allowed=1 ;; esac
  done <"$allow"
  if [ $allowed = 0 ]; then
    echo "symbols: the core needs $name, which is not in $(basename "$allow"); asked for by:" >&2
    "${prefix}nm" -A "$@" | grep -E " [Uwv] $name\$" >&2 || true
    failed=1
  fi
done
# .data.rel.ro is constant once loaded: position independent code keeps tables of addresses there.
ram=$("${prefix}size" -A "$@" | awk '
  / :$|^[^ ]+ +:|\(ex / { member = $1 }
  $1 ~ /^\.(data|bss|sdata|sbss|tdata|tbss|init_array|fini_array|ctors|dtors|preinit_array)(\.|$)/ &&
    $1 !~ /^\.data\.rel\.ro/ && $2 > 0 { print member, $1, $2 " bytes" }')
if [ -n "$ram" ]; then
  echo "$ram" >&2
  echo "symbols: the core must hold no writable data and run no constructors" >&2
  failed=1
fi
exit $failed
