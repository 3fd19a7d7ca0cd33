#!/bin/sh
# The command without the wide renderer, and without windows and the GPU as well: each builds where the packages are not looked for,
# says what it lacks, and draws the same picture.      lean.sh ROOT WORK_DIR THIMBLE
set -eu
root=$1
work=$2
whole=$3
mkdir -p "$work"
failed=0
complain() {
  echo "lean: $1" >&2
  failed=1
}
# lacks PACKAGE STATUS WHAT ARGUMENT...: whether it is off; then --version says so, and the command is refused with the option's name.
lacks() {
  package=$1
  refusal=$2
  what=$3
  shift 3
  case " $off " in *" $package "*) ;; *) return 1 ;; esac
  case $said in *"not in this build (-DTHIMBLE_$package=OFF)"*) ;; *) complain "--version does not say that $package is off" ;; esac
  status=0
  "$thimble" "$@" >/dev/null 2>"$work/why" || status=$?
  [ $status = "$refusal" ] && grep -q "THIMBLE_$package=OFF" "$work/why" || complain "without $off, $what: exit $status, $(cat "$work/why")"
}
# A picture that is the core's, whatever draws it.
"$whole" render castle --size 160x120 --quiet -o "$work/whole.ppm"
for off in 'WINDOW WIDE GPU' WIDE; do
  options=
  for package in WINDOW:X11 WIDE:TBB; do
    case " $off " in
      *" ${package%:*} "*) options="$options -DTHIMBLE_${package%:*}=OFF -DCMAKE_DISABLE_FIND_PACKAGE_${package#*:}=ON" ;;
      *) options="$options -DTHIMBLE_${package%:*}=ON -DCMAKE_DISABLE_FIND_PACKAGE_${package#*:}=OFF" ;;
    esac
  done
  case " $off " in *' GPU '*) options="$options -DTHIMBLE_GPU=OFF" ;; *) options="$options -DTHIMBLE_GPU=ON" ;; esac
  # Not optimised, in one folder: what the options do not touch is compiled once.
  cmake -S "$root" -B "$work/build" -G Ninja -Wno-dev -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DTHIMBLE_TESTS=OFF \
    -DTHIMBLE_GOLDEN=OFF $options >"$work/log" 2>&1 && cmake --build "$work/build" --target thimble_command >"$work/log" 2>&1 || {
    tail -n 20 "$work/log" >&2
    complain "without $off it does not build"
    continue
  }
  thimble=$work/build/thimble
  said=$("$thimble" --version)
  libraries=$(ldd "$thimble")
  "$thimble" render castle --size 160x120 --quiet -o "$work/lean.ppm" || complain "without $off it does not draw"
  cmp -s "$work/whole.ppm" "$work/lean.ppm" || complain "without $off the picture is another one"
  "$thimble" render lagoon --threads 3 --size 80x60 --quiet -o "$work/lagoon.ppm" || complain "without $off it does not draw the lagoon"
  lacks WIDE 2 '--engine wide' render castle --engine wide -o "$work/none.png" && {
    case $libraries in *libtbb* | *libhwy*) complain "without $off it is linked with oneTBB or Highway" ;; esac
    "$thimble" sim spheres --app demo --display none --frames 1 --quiet >/dev/null || complain "without $off the simulator does not run"
  }
  lacks GPU 2 '--engine gpu' render castle --shade color --engine gpu -o "$work/none.png" || :
  lacks WINDOW 1 '--display window' sim spheres --display window --frames 1 --quiet && {
    case $libraries in *libX11*) complain "without $off it is linked with libX11" ;; esac
  }
done
[ $failed = 0 ] && echo "lean: two builds, as wanted"
exit $failed
