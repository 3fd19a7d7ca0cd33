#!/bin/sh
# Every link of every page that leads into the repository leads to something that is there, a page's heading among it.
# links.sh ROOT
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
        heading = link ~ /#/ ? substr(link, index(link, "#") + 1) : ""
        sub(/#.*$/, "", link)
        if (link heading == "" || link ~ /^[a-z]+:/) continue
        folder = FILENAME
        sub(/[^\/]*$/, "", folder)
        print FILENAME ":" FNR, link == "" ? FILENAME : link ~ /^\// ? "." link : folder link, heading
      }
    }' | while read -r place path heading; do
    [ -e "$path" ] || echo "$place leads to $path"
    case $path in *.md) ;; *) continue ;; esac
    [ ! -e "$path" ] || [ -z "$heading" ] || sed -n 's/^##* //p' "$path" | tr 'A-Z ' 'a-z-' | tr -cd 'a-z0-9_\n-' |
      grep -qxe "$heading" || echo "$place leads to $path#$heading"
  done)
if [ -n "$broken" ]; then
  echo "$broken"
  echo "links: these lead to nothing" >&2
  exit 1
fi
