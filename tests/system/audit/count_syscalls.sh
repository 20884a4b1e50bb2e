#!/bin/sh
# count_syscalls.sh MIN:MAX PROGRAM ARGUMENTS...: runs the program under strace, counts the system calls that its
# real-time loop makes while its thread bears the loop's name, prints them, and fails (1) if there is any but receive,
# sleep and clock, or if the sleeps are not MIN to MAX (MAX left out: no upper bound). Skips (77) without strace.
min=${1%%:*} max=${1#*:}
shift
command -v strace > /dev/null || { echo "count_syscalls: strace is missing: apt-get install strace"; exit 77; }
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
strace -ff -qq -o "$folder/trace" "$@" || { echo "count_syscalls: $1 ended with status $?"; exit 1; }
trace=$(grep -l 'prctl(PR_SET_NAME, "stillcut-loop")' "$folder"/trace.*)
[ -f "$trace" ] || { echo "count_syscalls: no thread, or more than one, was named stillcut-loop"; exit 1; }
awk -v min="$min" -v max="$max" '
  /^prctl\(PR_SET_NAME, "stillcut-loop"\)/ { inside = 1; next }
  /^prctl\(PR_SET_NAME/ { inside = 0 }
  inside && /^[a-z]/ { sub(/\(.*/, ""); ++count[$0] }
  END {
    for (name in count) {
      printf "%8d %s\n", count[name], name
      if (name !~ /^(recvmmsg|recvmsg|recvfrom|clock_nanosleep|clock_gettime|restart_syscall)$/) {
        printf "count_syscalls: the real-time loop called %s\n", name
        bad = 1
      }
    }
    sleeps = count["clock_nanosleep"] + 0
    if (sleeps < min + 0 || (max != "" && sleeps > max + 0)) {
      printf "count_syscalls: %d sleeps, wanted %s to %s\n", sleeps, min, max
      bad = 1
    }
    exit bad
  }' "$trace"
