#!/bin/bash
# units.sh UNITS PROGRAMS: systemd finds nothing to say about the units in the folder UNITS, and rates the service's
# exposure 2.0 or better. Breaks on an unknown key or section, a missing program, a loosened sandbox.
set -eu
units=$1 programs=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "units: $*" >&2; exit 1; }

# Verified at the places where they are installed, in as far as this machine has them: here the programs are elsewhere.
for unit in "$units"/*.service; do
  sed -e "s|/usr/bin/stillcut|$programs/stillcut|; s|/usr/lib/stillcut/|$units/|; s|/usr/sbin/ip|$(command -v ip)|" "$unit" \
    > "$work/$(basename "$unit")"
done
verify() {
  local said
  said=$(SYSTEMD_UNIT_PATH=$work: systemd-analyze verify --man=no "$@" 2>&1) || fail "verify ended with $?: $said"
  [ -z "$said" ] || fail "verify says: $said"
}
verify "$work"/stillcutd@cell.service "$work"/stillcut-can@can0.service "$work"/stillcut-vcan@vcan0.service \
  "$work"/stillcut-scope@cell.service "$work"/stillcut-dds@cell.service "$work"/stillcut-multicast.service

sed -i 's/^WatchdogSec/WatchDogSec/' "$work/stillcutd@.service"  # the proof that a slip is found
if (verify "$work"/stillcutd@cell.service) 2> /dev/null; then fail 'a misspelt key passed'; fi
sed -i 's/^WatchDogSec/WatchdogSec/' "$work/stillcutd@.service"

rate() { systemd-analyze security --offline=true --threshold=20 "$work/${1:-stillcutd@.service}"; }
for unit in stillcut-scope@.service stillcut-dds@.service stillcutd@.service; do
  rate $unit > "$work/rated" || fail "exposure of $unit: $(tail -n 1 "$work/rated")"
  tail -n 1 "$work/rated"
done
sed -i '/^SystemCallFilter\|^CapabilityBoundingSet/d' "$work/stillcutd@.service"
! rate > /dev/null || fail 'a service without system-call filter and with every capability passed'
grep -q CAP_NET_ADMIN "$units/stillcutd@.service" && fail 'CAP_NET_ADMIN is not to be had' || true

# The back-off, its sleeping replaced by saying: four restarts at once, then twice as long each, half a minute at most.
mkdir "$work/bin"
printf '#!/bin/sh\necho "$1"\n' > "$work/bin/sleep"
chmod 755 "$work/bin/sleep"
waits() { for _ in {1..12}; do RUNTIME_DIRECTORY=$work PATH=$work/bin:$PATH "$units/back-off" true | grep -v 'in a row' || echo 0; done | paste -sd' '; }
waited=$(waits)
[ "$waited" = '0 0 0 0 0 1 2 4 8 16 30 30' ] || fail "back-off waits for $waited s"
echo "$(($(date +%s) - 61)) 7" > "$work/starts"
[ "$(RUNTIME_DIRECTORY=$work "$units/back-off" echo started)" = started ] || fail 'a start after a quiet minute waits'
