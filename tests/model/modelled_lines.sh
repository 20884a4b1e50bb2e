#!/bin/sh
# modelled_lines.sh HEADER LINES: fails when the code that a model stands for is no longer that which it was written
# from. `modelled_lines.sh HEADER` prints them as they are.
set -u
lines() { sed -nE '/^  .*(bool push|void publish)\(/,/^};/p' "$1" | sed -E 's, *//.*,,; s/^ +//' | grep -v '^$'; }
[ $# = 2 ] || { lines "$1"; exit; }
lines "$1" | diff "$2" - && exit
echo "modelled_lines: $1 has changed: bring the model beside ${2##*/} to it, then write those lines there"
exit 1
