# Helpers of the scripts that run inside the guest kernel (sourced; bash).
set -u

fail() { echo "guest: $*"; exit 1; }

# Waits until COMMAND succeeds, a minute at most.
until_true() {
  for _ in {1..1200}; do "$@" && return; sleep 0.05; done
  fail "waited in vain for: $*"
}

listening() { grep -qs '^ *vcan0 ' /proc/net/can/rcvlist_{all,fil,sff,eff,inv}; }

# start_daemon [OPTION...]: stillcutd on vcan0, recording to $record (record.log), events to live.csv, with the library $preload,
# if that is set; returns when its socket listens. The guest's one slow processor keeps no time, which is not asked of it here.
start_daemon() {
  env ${preload:+LD_PRELOAD="$preload"} \
    ./stillcutd cell/live.toml --allow-not-real-time --record "${record:-record.log}" --events live.csv --json "$@" \
    > daemon.out 2> daemon.err &
  daemon=$!
  until_true listening
}

alive() { kill -0 $daemon 2> /dev/null || fail "the daemon died: $(tail -3 daemon.err)"; }

# Asks the daemon to end as a service manager would; a clean end is exit status 0.
stop_daemon() {
  alive
  sleep 0.05  # the last frames are still on their way
  kill -TERM $daemon
  wait $daemon
  local status=$?
  [ $status = 0 ] || fail "the daemon ended with $status: $(tail -3 daemon.err)"
}

# play LOG: sends the frames of a log on vcan0 at their own pace. Real-time priority: the guest has one slow processor.
play() { chrt -f 40 canplayer -I "$1" "vcan0=$(awk '{print $2; exit}' "$1")" || fail "canplayer $1"; }

# from_to LOG START END: the lines of a log between two times in seconds after its first frame.
from_to() {
  awk -v a="$2" -v b="$3" '{t = substr($1, 2, length($1) - 2)} NR == 1 {t0 = t} t - t0 >= a && t - t0 < b' "$1"
}

# sensor_id LOG: the identifier seen most often, in hexadecimal.
sensor_id() { awk '{split($3, a, "#"); n[a[1]]++} END {for (i in n) if (n[i] > n[best]) best = i; print best}' "$1"; }
