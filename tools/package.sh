#!/bin/sh
# Makes Debian packages of what a build installs, into the build's folder or TO, and names them: thimble, its shared
# library, and libthimble-dev. A commit makes the same bytes: files are as old as SOURCE_DATE_EPOCH or the commit says.
#   package.sh BUILD_DIR [TO]
set -eu
for need in dpkg-shlibdeps dpkg-deb gzip cpack; do
  if ! command -v $need >/dev/null 2>&1; then
    echo "thimble: Debian packages need $need (packages dpkg-dev, dpkg, gzip, cmake)" >&2
    exit 1
  fi
done
to=$(cd "${2:-$1}" && pwd)
if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
  SOURCE_DATE_EPOCH=$(git -C "$(dirname "$0")/.." log -1 --format=%ct 2>/dev/null || date +%s)
fi
export SOURCE_DATE_EPOCH
cd "$1"
rm -rf _CPack_Packages *thimble*.deb
umask 022
if ! cpack -G DEB >package.log 2>&1; then
  cat package.log >&2
  exit 1
fi
rm -rf _CPack_Packages
# CPack keeps the day that a file was written on; dpkg-deb puts it no later than the commit.
for made in *thimble*.deb; do
  rm -rf package.root
  dpkg-deb -R "$made" package.root
  rm -f package.root/DEBIAN/postinst package.root/DEBIAN/postrm  # CPack's call ldconfig, which the trigger does
  find package.root -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
  [ "$to" = "$PWD" ] || rm -f "$made"
  dpkg-deb --root-owner-group -Zxz -b package.root "$to/$made" >/dev/null
  echo "package: ${2:-$1}/$made"
done
rm -rf package.root
