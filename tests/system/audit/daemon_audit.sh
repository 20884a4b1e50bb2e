#!/bin/bash
# daemon_audit.sh PROGRAMS MALLOC_AUDIT CELL
#
# The audits on the real daemon: stillcutd plays and records a simulated cut with chatter for more than 10 000 ticks, once under the
# count of heap calls and locks on its loop thread, once with every system call but receive, sleep and clock forbidden.
set -u
programs=$1 malloc_audit=$2 cell=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "daemon_audit: $*"; exit 1; }

folder=$(dirname "$cell")
cp -r "$folder" "$work/cell"
sed -e 's/^bus = .*/bus = "log:cut.log"/' "$cell" > "$work/cell/live.toml"
printf '\n[lcm]\nurl = "memq://"\n' >> "$work/cell/live.toml"
"$programs/stillcut" simulate "$cell" --duration 13 --can "$work/cell/cut.log" \
  --depth 0:0,0.7:0,0.8:1.5,2:1.5,3:3.6,9:3.6,9.1:0 > /dev/null || fail 'no cut to play'

cd "$work"
LD_PRELOAD=$malloc_audit "$programs/stillcutd" cell/live.toml --record heap --json > heap.json 2> heap.err &
heap=$!
"$programs/stillcutd" cell/live.toml --record calls --audit --json > calls.json 2> calls.err &
calls=$!
wait $heap || fail "heap and locks: status $?: $(tail -n 3 heap.err)"
wait $calls || fail "system calls: status $?: $(tail -n 3 calls.err)"
for run in heap calls; do
  ticks=$(sed -nE 's/.*"ticks":([0-9]+).*/\1/p' $run.json)
  [ "${ticks:-0}" -ge 10000 ] || fail "$run: only ${ticks:-no} ticks were watched"
  grep -q '"chatter_onsets":[1-9]' $run.json || fail "$run: the run met no chatter, so it did not go where it must"
done
grep malloc heap.err
echo "daemon_audit: $ticks ticks without a heap call, a lock or a forbidden system call"
