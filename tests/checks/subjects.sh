#!/bin/sh
# The subject of every commit since BASE is at most 72 characters long, so that lists and mails show it whole. Those before
# are as they are. Where there is no such history, as in a shallow clone or an archive, it is skipped.
# subjects.sh ROOT [BASE]
set -eu
cd "$1"
base=${2:-bb82b4cff1e73459ce9a679454f9b1898d86d476}
if [ ! -e .git ] || ! git cat-file -e "$base^{commit}" 2>/dev/null; then
  echo "skipped: there is no history since $base"
  exit 77
fi
git log --format='%h %s' "$base..HEAD" | LC_ALL=C.UTF-8 python3 -c '
import sys
long = [line for line in map(str.rstrip, sys.stdin) if len(line.split(" ", 1)[1]) > 72]
print("".join(f"subjects: {line}\n  has more than 72 characters\n" for line in long), end="")
sys.exit(1 if long else 0)'
