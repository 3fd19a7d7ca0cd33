#!/bin/sh
# Renders the paper's scenes and a castle in colour, each within a fixed budget of memory, and prints what they took. run_demo.sh THIMBLE OUT_DIR
# Every picture is written twice, as PNG and as PPM, by two runs that must agree in the CRC-32 of their pixels.
set -eu
thimble=$1
out=$2
mkdir -p "$out"

# json_value FILE KEY: a number or a string of a flat JSON object, however it is laid out.
json_value() {
  { tr '\n' ' ' <"$1"; echo; } | sed -n \
    -e 's/.*"'"$2"'"[[:space:]]*:[[:space:]]*"\([^"]*\)".*/\1/p' -e t \
    -e 's/.*"'"$2"'"[[:space:]]*:[[:space:]]*\([^][:space:],}]*\).*/\1/p'
}

# draw NAME BUDGET SCENE OPTION...
draw() {
  name=$1
  budget=$2
  shift 2
  for ending in png ppm; do
    "$thimble" render "$@" --memory "$budget" --quiet --stats "$out/$name.$ending.json" -o "$out/$name.$ending"
  done
  png=$(json_value "$out/$name.png.json" frame_crc32)
  ppm=$(json_value "$out/$name.ppm.json" frame_crc32)
  if [ -z "$png" ] || [ "$png" != "$ppm" ]; then
    echo "run: $name.png and $name.ppm are not the same picture (CRC-32 '$png' and '$ppm')" >&2
    exit 1
  fi
  mv "$out/$name.png.json" "$out/$name.json"
  rm "$out/$name.ppm.json"
  for key in budget_bytes high_water_bytes voxels depth frame_seconds; do
    json_value "$out/$name.json" $key
  done | tr '\n' ' ' | awk -v name="$name" 'NF != 5 {
      print "run: " name ".json lacks a key" > "/dev/stderr"
      exit 1
    }
    { printf "%-22s %12d %12d %10d %6d %16.3f\n", name, $1, $2, $3, $4, $5 }'
}

printf '%-22s %12s %12s %10s %6s %16s\n' scene 'budget bytes' 'used bytes' voxels depth 'seconds a frame'
paper="--shade depth --view paper"
draw spheres-perspective 64K spheres --projection perspective --fov 60 $paper
draw spheres-orthographic 64K spheres --projection orthographic $paper
draw cluster-perspective 6M cluster:1000000 --projection perspective --fov 60 $paper
draw castle 256K "$(dirname "$0")/gallery/scenes/castle.vox" --shade color \
  --effects direct-light,shadows,sky,ambient-occlusion --eye 2,-118,72 --target 40,40,29 --fov 32
echo "pictures: $out/*.png, $out/*.ppm"
