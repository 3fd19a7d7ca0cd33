# To be sourced: `blocks` prints a small room in the sun, to which a scene adds what it is about.
blocks() {
  cat <<'TEXT'
depth 5
camera eye 40 -14 26 target 15 16 6 fov 40
sun toward 6 -5 9
material floor color 190 180 160
material steel color 120 160 226
box floor from 0 0 0 to 32 32 2
box floor from 0 30 2 to 32 32 20
ball steel at 18 14 9 radius 7
box steel from 3 18 2 to 12 27 14
TEXT
}
some_water='water level 6 floor 2 color 84 176 190 index 1.333 density 0.05'
