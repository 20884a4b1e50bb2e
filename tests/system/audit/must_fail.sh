#!/bin/sh
# must_fail.sh STATUS REGEX COMMAND...: passes if the command exits with that status and says something that matches.
# 77, a skipped test, stays 77.
wanted=$1 regex=$2
shift 2
said=$("$@" 2>&1)
status=$?
printf '%s\n' "$said"
[ $status -eq 77 ] && exit 77
if [ $status -ne "$wanted" ]; then
  echo "must_fail: status $status, wanted $wanted" >&2
  exit 1
fi
printf '%s\n' "$said" | grep -Eq -- "$regex" || { echo "must_fail: nothing matches $regex" >&2; exit 1; }
