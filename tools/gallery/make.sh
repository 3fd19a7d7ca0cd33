#!/bin/sh
# Renders the pictures of the READMEs into this folder. make.sh THIMBLE DATA_DIR
# DATA_DIR holds the files named below; stars.xyz is made from the star catalogue as README.md shows. The scenes of
# this folder are in the repository; castle.py and the other scripts make scenes/ again.
set -eu
thimble=$1
data=$2
out=$(dirname "$0")
size="--size 480x360 --quiet"

$thimble render spheres --shade depth --depth 9 $size --eye -130,-300,520 --target 256,256,262 --fov 52 -o "$out/spheres-perspective.png"
$thimble render spheres --shade depth --depth 9 $size --view paper --projection orthographic --span 860 -o "$out/spheres-orthographic.png"
$thimble render cluster:1000000 --shade depth $size --eye 40,-420,900 --target 512,512,470 --fov 48 -o "$out/cluster.png"
$thimble render "$data/vox/ephtracy/monu10.vox" $size --shade color --view paper --fov 30 -o "$out/monu10.png"
$thimble render "$data/mesh/dragon_vrip_res2.ply.gz" --depth 10 $size --shade depth --eye 300,-760,620 \
  --target 512,512,425 --fov 44 -o "$out/dragon.png"
$thimble render "$data/nbody/galaxy_littleendian.dat" $size --shade color --eye 100,60,700 --target 256,256,256 --fov 60 \
  -o "$out/galaxy.png"
$thimble render "${STARS:-stars.xyz}" --shade depth --depth 10 $size --eye 300,-60,760 --target 512,512,512 --fov 44 -o "$out/stars.png"
scenes="$out/scenes"
$thimble render "$scenes/castle.vox" $size --samples 9 --shade color --effects direct-light,shadows,sky,ambient-occlusion \
  --eye 2,-118,72 --target 40,40,29 --fov 32 -o "$out/castle.png"
$thimble render "$scenes/fox.vox.gz" $size --samples 9 --shade color --effects direct-light,shadows,sky,ambient-occlusion \
  --eye 20,-110,75 --target 42,42,38 --fov 36 -o "$out/fox.png"
# Lit by what their texts say.
for scene in house lagoon ship glass room; do
  $thimble render "$scenes/$scene.scene" $size --samples 9 --effects auto -o "$out/$scene.png"
done
$thimble render "$data/vox/bevy/test.vox" $size --samples 9 --effects direct-light,shadows,ambient-occlusion,sky,glass,media \
  --eye 141.3,-22.7,66.4 --target 25.6,59.2,9.3 --fov 36 -o "$out/bevy-test.png"
$thimble particles --steps 45 --figures --quiet -o "$out/particles.png"
$thimble particles --steps 2000 --figures --quiet -o "$out/particles-heap.png"
$thimble sim demo --board raspi0 --display none --frames 1 --quiet --shot "$out/demo-raspi0.png" >/dev/null
$thimble sim demo --board pico --display none --frames 1 --quiet --shot "$out/demo-pico.png" >/dev/null
# What the OLED shows with light, magnified (ImageMagick).
for picture in castle demo room; do
  effects=auto
  case $picture in
    castle) scene=$scenes/oled.scene effects= ;;
    demo) scene=demo effects=direct-light,shadows ;;
    room) scene=$scenes/room.scene ;;
  esac
  $thimble sim "$scene" ${effects:+--effects $effects} --board lm3s6965evb --display none --frames 2 --quiet --shot "$out/oled-$picture.png" >/dev/null
  convert "$out/oled-$picture.png" -filter point -resize 300% "$out/oled-$picture.png"
done
$thimble sim "$out/scenes/waves.scene" --board raspi0 --display none --frames 100 --fps 25 --keys "$out/waves.keys" --quiet \
  --record "$out/waves.y4m" >/dev/null
ffmpeg -loglevel error -y -i "$out/waves.y4m" -vf "fps=12.5,scale=320:-1:flags=lanczos,split[a][b];[a]palettegen=max_colors=112[p];\
[b][p]paletteuse=dither=none:diff_mode=rectangle" "$out/waves.gif"
rm "$out/waves.y4m"
sh "$out/sheet.sh" "$thimble" "$data"
# simulator.png is the window of: thimble sim demo

# The studies of tools/README.md. Their titles are the names of the files, so they run where these lie.
plots=$(cd "$out" && pwd)
case $thimble in */*) thimble=$(cd "$(dirname "$thimble")" && pwd)/$(basename "$thimble") ;; esac
(
  cd "$data/mesh"
  "$thimble" memory dragon_vrip_res2.ply.gz --depth 10 --quiet --plot "$plots/memory-dragon.svg" >/dev/null
  "$thimble" accuracy dragon_vrip_res2.ply.gz --shade normal --quiet --plot "$plots/accuracy-dragon.svg" >/dev/null
  cd ../vox/ephtracy
  "$thimble" memory monu10.vox --shade color --fov 30 --quiet --plot "$plots/memory-monu10.svg" >/dev/null
  "$thimble" accuracy monu10.vox --shade color --fov 30 --quiet --plot "$plots/accuracy-monu10.svg" >/dev/null
)
"$thimble" memory points:1000000 --quiet --plot "$plots/memory-points.svg" >/dev/null
