#!/bin/sh
# Makes the folder that device.sh takes along: device_folder.sh FOLDER BENCH_DEVICE THIMBLE SCENE...
# A scene NAME.oct that is not in the folder yet is baked from the scene NAME, points in a world of 1,024. Takes a minute
# or two: the CRCs are the core's.
set -eu
folder=$1
bench=$2
thimble=$3
shift 3
mkdir -p "$folder/lib"
cp "$bench" "$folder/bench_device"
for scene in "$@"; do
  depth=
  case $scene in points:*) depth=,depth=10 ;; esac
  [ -e "$folder/$scene" ] || "$thimble" bake "${scene%.oct}$depth" --effects none -o "$folder/$scene" --quiet
done
# The loader, and what NVIDIA's driver is linked with.
for name in libvulkan.so.1 libX11.so.6 libXext.so.6 libxcb.so.1 libXau.so.6 libXdmcp.so.6 libbsd.so.0 libmd.so.0; do
  file=$(find /usr/lib/*/"$name" /lib/*/"$name" 2>/dev/null | head -n 1)
  [ -z "$file" ] || cp -L "$file" "$folder/lib/$name"
done
echo "$@" >"$folder/scenes.txt"
cd "$folder"
./bench_device expect "$@" >expected.txt
