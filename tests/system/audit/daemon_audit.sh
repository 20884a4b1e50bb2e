#!/bin/bash
# daemon_audit.sh PROGRAMS LOOP_AUDIT CELL played|unlocked|stopped
#
# The audits on the real daemon, shadow mode, recording: heap calls, locks and page faults of its loop thread are counted, every system
# call but receive, sleep and clock is forbidden.
#   played    it plays a simulated cut with chatter, for more than 10 000 ticks
#   unlocked  the same without the right to lock memory, where all that the loop needs must have been touched before
#   stopped   it hears a simulated machine in another process, and is stopped for a while, so that it falls out of time
set -u
programs=$1 loop_audit=$2 cell=$3 how=$4
work=$(mktemp -d)
daemon=
trap '[ -z "$daemon" ] || kill -9 $daemon 2> /dev/null; rm -rf "$work"' EXIT
fail() { echo "daemon_audit: $*"; exit 1; }

folder=$(dirname "$cell")
cp -r "$folder" "$folder/../scenarios" "$work"
cd "$work" || exit 1
live=$(basename "$folder")/live.toml
# on BUS: the cell, on that bus and on messages within the process
on() {
  sed -e "s/^bus = .*/bus = \"$1\"/" "$cell" > "$live"
  printf '\n[lcm]\nurl = "memq://"\n' >> "$live"
}
without=()
if [ "$how" = unlocked ]; then
  without=(prlimit --memlock=65536:65536)
  [ "$(id -u)" != 0 ] || without+=(setpriv --bounding-set -ipc_lock)
fi
start_daemon() {
  "${without[@]}" env LD_PRELOAD="$loop_audit" "$programs/stillcutd" "$live" --record recording --audit --json \
    > summary.json 2> errors &
  daemon=$!
}

least=10000
if [ "$how" = stopped ]; then
  least=3000
  on "local:audit-$$"
  start_daemon
  "$programs/stillcut" plant "$live" --scenario scenarios/depth-step.toml > plant.out 2>&1 &
  plant=$!
  sleep 3
  kill -STOP $daemon
  sleep 0.2
  kill -CONT $daemon
  wait $plant || fail "plant: $(cat plant.out)"
  kill -TERM $daemon
else
  on log:cut.log
  "$programs/stillcut" simulate "$cell" --duration 13 --can "$(basename "$folder")/cut.log" \
    --depth 0:0,0.7:0,0.8:1.5,2:1.5,3:3.6,9:3.6,9.1:0 > /dev/null || fail 'no cut to play'
  start_daemon
fi
wait $daemon
status=$? daemon=
[ $status = 0 ] || fail "status $status: $(tail -n 3 errors)"
grep loop_audit errors
ticks=$(sed -nE 's/.* in ([0-9]+) sleeps.*/\1/p' errors)
[ "${ticks:-0}" -ge $least ] || fail "only ${ticks:-no} ticks were watched"
# That the run went where it must.
if [ "$how" = stopped ]; then
  grep -q '"times_out":[1-9]' summary.json || fail "it did not fall out of time: $(cat summary.json)"
else
  grep -q '"chatter_onsets":[1-9]' summary.json || fail 'it met no chatter'
fi
[ "$how" != unlocked ] || grep -q 'memory not locked' errors || fail 'memory was locked all the same'
