#!/bin/bash
# service.sh BUILD HANG_LOOP [long]
#
# The installed package under a real systemd: makes a Debian 12 root folder, installs an older version in it, upgrades,
# purges (nothing may be left), installs again, and boots the folder in User-mode Linux with systemd as process 1, where
# guest-test plays on. Needs root, as every installation does. BUILD/packages has the packages, from packages.sh.
# long: there also with a wrong cell file, a missing interface, and an upgrade and a purge while the service runs.
set -eu
build=$1 hang_loop=$2
here=$(cd "$(dirname "$(readlink -f "$0")")" && pwd)
. "$here/root_folder.sh"
fail() { echo "service: $*" >&2; exit 1; }
if [ "$(id -u)" != 0 ]; then exec sudo -n "$0" "$@"; fi
package=$(ls "$build"/packages/stillcut_*.deb) older=$(ls "$build"/packages/older/stillcut_*.deb)
kernel=$(basename /usr/lib/uml/modules/*)
work=$(mktemp -d /tmp/stillcut-service.XXXXXX)
root=$work/root
trap 'rm -rf "$work"' EXIT
mkdir "$root" "$work/umid"

unpack_root "$build" "$package" "$root"

in_root() { LC_ALL=C DEBIAN_FRONTEND=noninteractive chroot "$root" "$@" > "$work/dpkg.log" 2>&1 || { cat "$work/dpkg.log"; fail "$*"; }; }
# Contents too; what dpkg and the account files keep for themselves left out.
files() { (cd "$root" && find . -path ./var/lib/dpkg -prune -o -path ./var/log -prune -o -type f -print0 | sort -z | xargs -0 md5sum &&
  find . -type d -print | grep -v '^./\(var/lib/dpkg\|var/log\)' | sort) | grep -vE ' \./etc/(passwd|group|g?shadow)-?$| \./etc/\.pwd\.lock$'; }
cp "$older" "$package" "$root/"
files > "$work/before"
in_root dpkg -i "/$(basename "$older")"
echo '# of this machine' >> "$root/etc/stillcut/example/cell.toml"
mkdir -p "$root/etc/stillcut/mine" "$root/var/lib/stillcut/mine"
touch "$root/etc/stillcut/mine/cell.toml" "$root/var/lib/stillcut/mine/cut.log"
in_root dpkg --force-confdef --force-confold -i "/$(basename "$package")"
[ "$(chroot "$root" dpkg-query -Wf '${Version}' stillcut)" = "$(dpkg-deb -f "$package" Version)" ] || fail 'not upgraded'
tail -n 1 "$root/etc/stillcut/example/cell.toml" | grep -q 'of this machine' || fail 'the upgrade took a changed cell file'
in_root dpkg --remove stillcut
[ -e "$root/etc/stillcut/mine/cell.toml" ] && [ -e "$root/var/lib/stillcut/mine/cut.log" ] || fail 'removing took cells or recordings'
in_root dpkg --purge stillcut
files > "$work/after"
diff "$work/before" "$work/after" || fail 'the purge left or took the above'
echo "install, upgrade, remove, purge: nothing is left"
in_root dpkg -i "/$(basename "$package")"
mkdir -p "$root/test/classes"
mv "$root/$(basename "$package")" "$root/test/stillcut.deb"
rm "$root"/*.deb

# A guest: this kernel's modules, the test and its helpers.
mkdir -p "$root/usr/lib/modules"
cp -a "/usr/lib/uml/modules/$kernel" "$root/usr/lib/modules/$kernel"
make_bootable "$root" "$here"/test.{service,target}
install -m 644 "$here"/{guest-test,controller.py,scenario.toml} "$here/../adapter_peer.py" "$hang_loop" "$root/test"
[ "${3:-}" != long ] || touch "$root/test/long"
lcm-gen --python --ppath "$root/test/classes" "$here"/../../../drivers/lcm/*.lcm

memory=/dev/shm
[ -d $memory ] && [ -w $memory ] || memory=/tmp
TMPDIR=$memory timeout -k 5 540 /usr/bin/linux.uml mem=768M root=/dev/root rootfstype=hostfs rootflags="$root" rw loglevel=1 \
  uml_dir="$work/umid" init=/sbin/init systemd.unit=test.target systemd.show_status=0 con=null con0=fd:0,fd:1 \
  < /dev/null 2> "$work/kernel" | tr -d '\r' || true
[ -s "$root/test/verdict" ] || { tail -n 5 "$work/kernel" >&2; fail 'the guest reported no verdict'; }
[ "$(cat "$root/test/verdict")" = 0 ] || fail 'see above'
