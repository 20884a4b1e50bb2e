#!/bin/bash
# daemon_audit.sh PROGRAMS LOOP_AUDIT CELL
#
# The audits on the real daemon: stillcutd plays and records a simulated cut with chatter for more than 10 000 ticks, under the count of
# heap calls, locks and page faults of its loop thread, and with every system call but receive, sleep and clock forbidden.
set -u
programs=$1 loop_audit=$2 cell=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "daemon_audit: $*"; exit 1; }

folder=$(dirname "$cell")
cp -r "$folder" "$work/cell"
sed -e 's/^bus = .*/bus = "log:cut.log"/' "$cell" > "$work/cell/live.toml"
printf '\n[lcm]\nurl = "memq://"\n' >> "$work/cell/live.toml"
"$programs/stillcut" simulate "$cell" --duration 13 --can "$work/cell/cut.log" \
  --depth 0:0,0.7:0,0.8:1.5,2:1.5,3:3.6,9:3.6,9.1:0 > /dev/null || fail 'no cut to play'

cd "$work" || exit 1
LD_PRELOAD=$loop_audit "$programs/stillcutd" cell/live.toml --record recording --audit --json > summary.json 2> errors ||
  fail "status $?: $(tail -n 3 errors)"
grep loop_audit errors
ticks=$(sed -nE 's/.* in ([0-9]+) sleeps.*/\1/p' errors)
[ "${ticks:-0}" -ge 10000 ] || fail "only ${ticks:-no} ticks were watched"
grep -q '"chatter_onsets":[1-9]' summary.json || fail 'the run met no chatter, so it did not go where it must'
