#!/bin/bash
# packages.sh SOURCE BUILD BUILD-ARM64: tools/package --arch arm64 makes packages that lintian finds no error in, that hold
# arm64 programs made from arm64 libraries alone, and that differ from the packages in BUILD/packages in nothing else:
# manual pages, completion, units, documents are the same, and so are the names of the packages they depend on. Debian 12 for
# arm64 has those.
set -eu
source=$1 build=$2 arm64=$3
fail() { echo "arm64 packages: $*" >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

rm -rf "$arm64/packages"
"$source/tools/package" --arch arm64
"$source/tools/package"  # of the same state of the tree
lintian --allow-root --fail-on error "$arm64"/packages/*.deb || fail "lintian ended with $?"

here=$(ls "$build"/packages/stillcut_*.deb) there=$(ls "$arm64"/packages/stillcut_*.deb)
[ "$(dpkg-deb -f "$there" Architecture)" = arm64 ] || fail "$there is not for arm64"
dpkg-deb -x "$here" "$work/here"
dpkg-deb -x "$there" "$work/there"
programs=("$work"/there/usr/bin/*)
[ ${#programs[@]} = 9 ] || fail "${#programs[@]} programs in $there, not 9"
for program in "${programs[@]}"; do
  readelf -h "$program" | grep -q 'Machine: *AArch64' || fail "$program is not for arm64"
done
diff -r "$work/here/usr/bin" "$work/there/usr/bin" | grep -q '^Only' && fail 'other programs than in the package for this machine'
rm -r "$work"/{here,there}/usr/bin
diff -r "$work/here" "$work/there" || fail "the packages' other files differ"
depends() { dpkg-deb -f "$1" Depends | tr -d ' ' | tr , '\n' | sed 's/(.*//' | sort; }
diff <(depends "$here") <(depends "$there") || fail 'the packages depend on different packages'
mmdebstrap --simulate --variant=extract --architectures=arm64 --include="$(realpath "$there")" bookworm "$work/none.tar" \
  > "$work/apt.log" 2>&1 || { tail -n 20 "$work/apt.log"; fail 'Debian 12 for arm64 has not all that the package depends on'; }

# Nothing of this machine's own headers went in: what the compiler read is the source, the root folder, or its own.
headers=$(ninja -C "$arm64" -t deps | sed -n 's/^    //p' | sort -u)
grep -q '^sysroot/' <<< "$headers" || fail 'no header of the root folder was read: is build-arm64 built?'
strange=$(grep '^/' <<< "$headers" | grep -vE "^($(realpath "$source")|/usr/lib/gcc-cross|/usr/aarch64-linux-gnu)/") || true
[ -z "$strange" ] || fail "compiled with headers of this machine: $(head -n 3 <<< "$strange")"
# What decides works in single operations: a fused multiply-add would round otherwise than on this machine.
for room in dsp rt; do
  fused=$(aarch64-linux-gnu-objdump -d "$arm64/$room/libstillcut_$room.a" | grep -cE '\sf(n?madd|n?msub|mla|mls)\s') || true
  [ "$fused" = 0 ] || fail "$room/ was compiled with $fused fused multiply-adds: is -ffp-contract=off gone?"
done
echo "arm64 packages: $(cd "$arm64/packages" && ls -s --block-size=1K *.deb | tr '\n' ' ')KiB; beside $(du -k "$here" | cut -f1) KiB for this machine"
