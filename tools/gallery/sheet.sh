#!/bin/sh
# Draws the sheet of README.md as a whole: twelve scenes without a word on how. sheet.sh THIMBLE DATA_DIR
# The files are those of make.sh, which calls this; stars.xyz is $STARS. Takes half a minute, and ImageMagick's montage.
set -eu
thimble=$1
data=$2
out=$(dirname "$0")
scenes="$out/scenes"
sheet=$(mktemp -d)
trap 'rm -r "$sheet"' EXIT
draw_all() {
  number=10
  for scene in "$@"; do
    "$thimble" render "$scene" --size 240x180 --quiet -o "$sheet/$number.png"
    number=$((number + 1))
  done
}
draw_all "$scenes/castle.vox" demo "$scenes/glass.scene" "$scenes/room.scene" "$scenes/lagoon.scene" spheres \
  "$data/mesh/dragon_vrip_res2.ply.gz" water "$data/nbody/galaxy_littleendian.dat" cluster:200000 points:20000 \
  "${STARS:-stars.xyz}"
# Without dates or paths: the same pictures make the same bytes.
montage "$sheet"/*.png -tile 3x4 -geometry +0+0 -strip -define png:exclude-chunks=date,time "$out/defaults.png"
