#!/bin/sh
# print_corrections.sh BUILD PROJECT: the handbook's print-corrections.py reads what the programs publish. A simulated cut is
# played into an LCM log; fails where the correction's fields are not read at their places: kind, target, reason.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cell=$2/examples/demo-cell/cell.toml
"$1/stillcut" simulate "$cell" --duration 2.5 --depth 0:0,0.2:0,0.3:1.5,0.8:1.5,1.1:3.6,2.1:3.6,2.2:0 --can "$folder/cut.log" > "$folder/said"
"$1/stillcut" replay "$cell" --can "$folder/cut.log" --publish "file://$folder/corrections.lcm?mode=w" > "$folder/said"
zstd -q "$folder/corrections.lcm"
for log in corrections.lcm corrections.lcm.zst; do
  /usr/bin/python3 "$2/docs/handbook/print-corrections.py" "$folder/$log" > "$folder/printed"
  # Once only: the target stands while the setpoint moves.
  [ "$(grep -c 'spindle speed' "$folder/printed")" = 1 ] &&
    grep -qE '^[0-9:.]+  shadow  spindle speed  75[0-9]{2} rpm  n = 60 f_c / \(N k\), k = 3$' "$folder/printed" || {
    echo "$log: the correction is not the one among:"
    cat "$folder/printed"
    exit 1
  }
done
