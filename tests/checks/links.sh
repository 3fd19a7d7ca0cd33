#!/bin/sh
# Every link of every page that leads into the repository leads to something that is there. links.sh ROOT
set -eu
cd "$1"
broken=$(find . \( -path ./build -o -path ./out -o -path ./.git \) -prune -o -name '*.md' -print | sort |
  xargs -r awk '
    FNR == 1 { code = 0 }
    /^[ \t]*```/ { code = !code; next }
    code || /^    / { next }
    {
      gsub(/`[^`]*`/, "")
      rest = $0
      while (match(rest, /\]\([^)]*\)|(src|href)="[^"]*"|^\[[^\]]*\]: *[^ ]+/)) {
        link = substr(rest, RSTART, RLENGTH)
        rest = substr(rest, RSTART + RLENGTH)
        sub(/^\]\(|^(src|href)="|^\[[^\]]*\]: */, "", link)
        sub(/[")]$/, "", link)
        sub(/[ \t].*$/, "", link)
        sub(/#.*$/, "", link)
        if (link == "" || link ~ /^[a-z]+:/) continue
        folder = FILENAME
        sub(/[^\/]*$/, "", folder)
        print FILENAME ":" FNR, link ~ /^\// ? "." link : folder link
      }
    }' | while read -r place path; do
    [ -e "$path" ] || echo "$place leads to $path"
  done)
if [ -n "$broken" ]; then
  echo "$broken"
  echo "links: these lead to nothing" >&2
  exit 1
fi
