#!/bin/sh
# A short fuzzing run. fuzz.sh PROGRAM TOPIC BUILD_DIR
# Seeds: the small files of THIMBLE_DATA whose name ends as the topic's files do, when it is set.
set -eu
program=$1
topic=$2
work=$3/runs/$topic
seconds=${THIMBLE_FUZZ_SECONDS:-3}
case $topic in
  vox) endings='vox' ;;
  ply) endings='ply' ;;
  obj) endings='obj' ;;
  off) endings='off' ;;
  points | text_points | xyz | csv) endings='xyz csv txt' ;;
  gadget | nbody) endings='dat' ;;
  schematic) endings='schematic schem litematic nbt' ;;
  octomap) endings='bt ot' ;;
  las) endings='las laz' ;;
  binvox | mts | pcd | stl | qb | qbcl | kvx | kv6 | vxl | gox) endings=$topic ;;
  npy) endings='npy npz' ;;
  gltf) endings='gltf glb' ;;
  gz | gzip | file_bytes) endings='gz' ;;
  *) endings= ;;
esac
mkdir -p "$work/corpus" "$work/seeds"
if [ -n "${THIMBLE_DATA:-}" ]; then
  for ending in $endings; do
    find "$THIMBLE_DATA" -type f -name "*.$ending" -size -64k -exec cp -f {} "$work/seeds/" \;
  done
else
  echo "THIMBLE_DATA is not set: starting without real files"
fi
# Those that come along are seeds, too.
case $topic in
  scene_text) cp -f "$(dirname "$0")"/../../tools/gallery/scenes/*.scene "$work/seeds" ;;
  vox) cp -f "$(dirname "$0")"/../../tools/gallery/scenes/*.vox "$work/seeds" ;;
esac
chmod -R u+w "$work/seeds"
if ! "$program" -max_total_time="$seconds" -rss_limit_mb=1024 -malloc_limit_mb=512 -timeout=10 -max_len=65536 \
  -artifact_prefix="$work/" -print_final_stats=1 "$work/corpus" "$work/seeds" >"$work/log" 2>&1; then
  tail -60 "$work/log"
  echo "fuzz: $topic failed; the input lies in $work" >&2
  exit 1
fi
grep -E 'stat::number_of_executed_units|INITED|DONE' "$work/log" || true
