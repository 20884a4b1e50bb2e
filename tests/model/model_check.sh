#!/bin/sh
# model_check.sh holds|rejected REGEX MODEL.pml -DWORD...: has spin search every execution of the model.
#
#   holds     passes if the search was complete, found no error, and reached every statement of the model; REGEX is what
#             was searched for: 'assertion violations' or 'non-progress cycles'
#   rejected  passes if the search found an error that matches REGEX
set -u
wanted=$1 regex=$2 model=$3
shift 3
command -v spin > /dev/null || { echo "model_check: spin is missing: apt-get install spin"; exit 1; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
fail() { echo "model_check: $*"; exit 1; }

case $regex in *non-progress*) kind=-DNP search=-l ;; *) kind=-DSAFETY search= ;; esac
optimised=-O1
[ "$wanted" = holds ] || optimised=-O0 search="$search -E"  # found at once; the mistake itself, not where it ends
cd "$work" || exit 1
spin -a "$@" "$model" || fail "spin does not take the model"
cc $optimised -w $kind -o pan pan.c || fail "the verifier does not compile"
# shellcheck disable=SC2086
./pan -m200000 $search > report 2>&1
grep -vE '^ *$|^Depth=' report | head -60
found() { grep -Eq -- "$1" report; }

if [ "$wanted" = rejected ]; then
  found 'errors: [1-9]' || fail "the planted mistake $* was not found"
  grep -E '^pan:[0-9]+:' report | grep -Eq -- "$regex" || fail "an error was found, but not: $regex"
  exit 0
fi
found 'errors: 0' || fail "the model is wrong"
found 'max search depth too small|[Ss]earch not completed|reached -DMEMLIM|out of memory' && fail "the search is incomplete"
found "^Full statespace search for" || fail "not the whole state space was searched"
found "$regex.*[+]" || fail "not searched for: $regex"
sed -n '/^unreached in/,$p' report | grep -E 'state [0-9]+' | grep -v D_STEP && fail "these statements were never reached"
exit 0
