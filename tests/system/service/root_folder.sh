# A Debian 12 root folder with systemd, for a guest that boots into it (sourced; bash; as root).

# unpack_root BUILD PACKAGE ROOT: fills the folder ROOT with what PACKAGE depends on and the tests need, not the package itself.
# Making that takes half a minute: it is kept as BUILD/service-root.tar.
unpack_root() {
  local build=$1 depends include
  depends=$(dpkg-deb -f "$2" Depends | sed 's/([^)]*)//g; s/|[^,]*//g; s/ //g')
  include=systemd,systemd-sysv,udev,dbus,kmod,procps,can-utils,python3-minimal,libpython3-stdlib,$depends
  if [ "$(cat "$build/service-root.list" 2> /dev/null)" != "$include" ]; then
    mmdebstrap --quiet --variant=minbase --include="$include" bookworm "$build/service-root.tar"
    echo "$include" > "$build/service-root.list"
  fi
  tar -x -C "$3" --exclude './dev/*' -f "$build/service-root.tar"
  mknod -m 666 "$3/dev/null" c 1 3
}

# make_bootable ROOT UNIT...: a guest without consoles and timers, which systemd boots to the target among the units.
make_bootable() {
  local root=$1 units=$1/etc/systemd/system unit
  shift
  for unit in getty.target getty@tty1.service console-getty.service systemd-timesyncd.service apt-daily.timer apt-daily-upgrade.timer \
    e2scrub_all.timer e2scrub_reap.service fstrim.timer dpkg-db-backup.timer systemd-pstore.service systemd-networkd.service; do
    ln -sf /dev/null "$units/$unit"
  done
  rm -rf "$units"/getty.target.wants
  : > "$root/etc/fstab"
  echo guest > "$root/etc/hostname"
  install -m 644 "$@" "$units"
}
