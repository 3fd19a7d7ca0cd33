#!/bin/sh
# Makes thimble_VERSION_ARCHITECTURE.deb of what a build installs, into the build's folder, and names it.
#   package.sh BUILD_DIR
set -eu
for need in dpkg-shlibdeps dpkg-deb gzip cpack; do
  if ! command -v $need >/dev/null 2>&1; then
    echo "thimble: a Debian package needs $need (packages dpkg-dev, dpkg, gzip, cmake)" >&2
    exit 1
  fi
done
cd "$1"
rm -rf _CPack_Packages thimble_*.deb
umask 022
if ! cpack -G DEB >package.log 2>&1; then
  cat package.log >&2
  exit 1
fi
rm -rf _CPack_Packages
echo "package: $1/$(ls thimble_*.deb)"
