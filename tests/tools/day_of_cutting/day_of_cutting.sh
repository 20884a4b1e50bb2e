#!/bin/bash
# day_of_cutting.sh BUILD EXAMPLES HOURS: ten minutes of the demo cell cut into a log, then HOURS of them (day_of_cutting.cpp).
set -eu
build=$1 examples=$2 hours=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$examples/demo-cell/." "$work"
sed -i 's/^mode = .*/mode = "active"/' "$work/cell.toml"
depth=0:0
for ((t = 0; t < 600; t += 20)); do
  depth+=,$((t + 1)):0,$((t + 1)).1:1.5,$((t + 9)):1.5,$((t + 9)).1:3.6,$((t + 11)):3.6,$((t + 11)).1:1.2,$((t + 18)):1.2,$((t + 18)).1:0
done
"$build/stillcut" simulate "$work/cell.toml" --duration 600 --depth "$depth" --can "$work/cut.log" > /dev/null
"$build/day_of_cutting" "$hours" "$work"
