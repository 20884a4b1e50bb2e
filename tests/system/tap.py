#!/usr/bin/python3
"""A guided tap test on a real CAN bus: canplayer sends simulated taps on vcan0, stillcutd runs in mode "measure", and
stillcut tap listens beside it, with written answers. The hits that it keeps must be those of the log, byte for byte.
"""
import json
import subprocess

from scenario import main, require

QUESTION = ["--posture", "home", "--directions", "x,-y", "--hits", "2"]

RUN = """
listeners() { cat /proc/net/can/rcvlist_{all,fil,sff,eff,inv} | grep -c '^ *vcan0 '; }
more_than() { [ "$(listeners)" -gt "$1" ]; }
attempt() {
  rm -rf taps
  local before=$(listeners)
  ./stillcut tap cell/live.toml QUESTION --out taps --json < answers > tap.json 2> tap.out &
  local tap=$!
  until_true more_than "$before"
  play taps.log
  for i in {1..100}; do kill -0 $tap 2> /dev/null || break; sleep 0.05; done
  kill $tap 2> /dev/null && { wait $tap; return 1; }
  wait $tap
}
start_daemon
for n in 1 2 3; do  # a machine that keeps the guest waiting loses frames, and with them hits
  attempt && break
  tail -3 tap.out
done
stop_daemon
""".replace("QUESTION", " ".join(QUESTION))


def guided(folder):
    cell = folder.path / "cell/live.toml"
    measuring = cell.read_text().replace('mode = "shadow"', 'mode = "measure"')
    require("measure" in measuring, "the cell has another mode than shadow")
    cell.write_text(measuring)
    (folder.path / "answers").write_text("a\na\n")
    folder.stillcut("tap", "cell/live.toml", *QUESTION, "--simulate", "taps.log")
    with open(folder.path / "answers") as answers:
        subprocess.run(["./stillcut", "tap", "cell/live.toml", *QUESTION, "--bus", "log:taps.log", "--out", "wanted"],
                       cwd=folder.path, stdin=answers, stdout=subprocess.DEVNULL, check=True)
    folder.in_guest(RUN)
    print(*folder.text("tap.out").splitlines()[-12:], sep="\n   ")
    directions = json.loads(folder.text("tap.json"))["postures"][0]["directions"]
    require([d["hits_used"] for d in directions] == [2, 2], f"other hits than two a direction: {directions}")
    for name in ("home.uff", "taps/home-x.uff", "taps/home-y.uff"):
        live, wanted = ((folder.path / where / name).read_bytes() for where in ("taps", "wanted"))
        require(live == wanted, f"{name}: what was heard on the bus is not what was sent")
    summary = folder.daemon_summary()
    print("  ", summary)
    require(summary["frames"] > 10000, "the daemon heard nothing of the taps")
    require(summary["corrections"] == 0, "a daemon that measures corrects")


main({"guided": guided}, __doc__)
