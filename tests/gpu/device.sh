#!/bin/sh
# Times the GPU renderer on this machine, checks every picture, and prints the table. It installs and compiles nothing,
# and ends within four minutes.      device.sh FOLDER [--quick]
#
# FOLDER is what `cmake --build build/release --target thimble_device_folder` makes: bench_device, expected.txt (the
# CRCs, by the core), baked scenes, scenes.txt (which are drawn), and in lib what Vulkan may lack on a machine without
# packages. The program needs glibc 2.36 and a Vulkan driver.
set -eu
folder=$1
shift
# Drivers in a container may lie where neither the loader nor the linker looks.
nvidia=/usr/local/nvidia
if [ -z "${VK_ICD_FILENAMES:-}" ] && [ -e $nvidia/share/vulkan/icd.d/nvidia_icd.json ]; then
  export VK_ICD_FILENAMES=$nvidia/share/vulkan/icd.d/nvidia_icd.json
fi
export LD_LIBRARY_PATH="${LD_LIBRARY_PATH:+$LD_LIBRARY_PATH:}$nvidia/lib64:$nvidia/lib"
# Only what is missing is taken from lib.
ldconfig=$(command -v ldconfig || echo /sbin/ldconfig)
lib=$(mktemp -d)
trap 'rm -rf "$lib"' EXIT
for library in "$folder"/lib/*; do
  name=$(basename "$library")
  "$ldconfig" -p 2>/dev/null | grep -q "[[:space:]]$name " || cp -L "$library" "$lib/"
done
export LD_LIBRARY_PATH="$LD_LIBRARY_PATH:$lib"
cd "$folder"
chmod +x bench_device
echo "$(uname -m), $(nproc) cores, $(getconf GNU_LIBC_VERSION)" >&2
run() { timeout "${THIMBLE_SECONDS:-235}" ./bench_device check expected.txt $(cat scenes.txt) "$@"; }
status=0
run "$@" || status=$?
if [ $status = 2 ] && [ -n "${VK_ICD_FILENAMES:-}" ]; then
  # NVIDIA's library for X11 does not open everywhere; that for EGL is a Vulkan driver, too.
  printf '{"file_format_version": "1.0.1", "ICD": {"library_path": "libEGL_nvidia.so.0", "api_version": "1.3.0"}}\n' \
    >"$lib/icd.json"
  export VK_ICD_FILENAMES="$lib/icd.json"
  status=0
  run "$@" || status=$?
fi
exit $status
