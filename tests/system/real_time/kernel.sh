#!/bin/bash
# kernel.sh BUILD: the installed package on Debian's PREEMPT_RT kernel, under systemd, in QEMU: its real-time set-up succeeds,
# and of a minute of a three-axis sensor at 25.6 kS/s (2560 CAN FD frames/s of 64 bytes on vcan0) it misses no frame.
# BUILD/packages has the packages. Needs root, as every installation does.
set -eu
build=$1
here=$(cd "$(dirname "$(readlink -f "$0")")" && pwd)
. "$here/../service/root_folder.sh"
fail() { echo "kernel: $*" >&2; exit 1; }
if [ "$(id -u)" != 0 ]; then exec sudo -n "$0" "$@"; fi
package=$(ls "$build"/packages/stillcut_*.deb)
root=$(mktemp -d /tmp/stillcut-rt.XXXXXX)
trap 'rm -rf "$root"' EXIT
unpack_root "$build" "$package" "$root"
cp "$package" "$root/stillcut.deb"
LC_ALL=C DEBIAN_FRONTEND=noninteractive chroot "$root" dpkg -i /stillcut.deb > "$root/dpkg.log" 2>&1 ||
  { cat "$root/dpkg.log"; fail 'not installed'; }
make_bootable "$root" "$here/test.service" "$here/../service/test.target"
mkdir "$root/test"
install -m 644 "$here/guest-test" "$root/test"
"$build/stillcut" simulate "$root/etc/stillcut/example/cell.toml" --duration 60 --seed 4 --can "$root/test/cut.log" > /dev/null
"$here/run-in-qemu" "$build/rt-kernel" "$root" test.target || true
[ -s "$root/test/verdict" ] || fail 'the guest reported no verdict'
[ "$(cat "$root/test/verdict")" = 0 ] || fail 'see above'
