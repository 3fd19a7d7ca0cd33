#!/bin/sh
# What every archive and every manifest must be, whoever builds it; and that a second run makes the same bytes.
name=manifests
. tests/packages/common.sh
mkdir -p "$WORK/again"
logged $python tools/packages/make.py --out "$WORK/again" --thimble "$PWD/build/release/thimble"
for made in "$WORK"/again/*; do
  cmp "$made" "$PACKAGES/$(basename "$made")" || fail "a second run makes another $(basename "$made")"
done
if ls "$PACKAGES"/thimble_*.deb >/dev/null 2>&1; then
  logged sh tools/package.sh build/release "$WORK/again"
  for made in "$WORK"/again/*.deb; do
    cmp "$made" "$PACKAGES/$(basename "$made")" || fail "a second run makes another $(basename "$made")"
  done
fi
$python tests/packages/manifests.py "$PACKAGES" || fail "see above"
$python tests/packages/manifests_selftest.py "$PACKAGES" || fail "a manifest with a fault is taken"
