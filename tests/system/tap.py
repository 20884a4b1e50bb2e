#!/usr/bin/python3
"""A guided tap test on a real CAN bus: canplayer sends simulated taps on vcan0, stillcutd runs in mode "measure", and
stillcut tap listens beside it, with a written answer. The hits that it keeps must be those of the log, bit for bit; where
this machine keeps the guest waiting until frames are lost, their hit is refused, and the log is played again.
"""
import json
import subprocess

from scenario import main, require

QUESTION = ["cell/live.toml", "--posture", "home", "--directions", "-y"]

RUN = """
listeners() { cat /proc/net/can/rcvlist_{all,fil,sff,eff,inv} | grep -c '^ *vcan0 '; }
more_than() { [ "$(listeners)" -gt "$1" ]; }
start_daemon
before=$(listeners)
./stillcut tap QUESTION --hits 2 --out taps --json < answers > tap.json 2> tap.out &
tap=$!
until_true more_than "$before"
for n in {1..6}; do
  play taps.log
  sleep 1
  kill -0 $tap 2> /dev/null || break
done
wait $tap || fail "stillcut tap: $(tail -3 tap.out)"
stop_daemon
""".replace("QUESTION", " ".join(QUESTION))


def hits_in(file):
    """The samples of each recording in a file: of the force and the three accelerations, as they stand in the file."""
    functions = [part.split(b"\n", 12)[12] for part in file.read_bytes().split(b"    -1\n    58b")[1:]]
    require(len(functions) % 4 == 0, f"{file} has not four functions a hit")
    return [tuple(data[:-len(b"    -1\n")] for data in functions[i:i + 4]) for i in range(0, len(functions), 4)]


def guided(folder):
    cell = folder.path / "cell/live.toml"
    measuring = cell.read_text().replace('mode = "shadow"', 'mode = "measure"')
    require("measure" in measuring, "the cell has another mode than shadow")
    cell.write_text(measuring)
    (folder.path / "answers").write_text("a\n")
    folder.stillcut("tap", *QUESTION, "--hits", "3", "--simulate", "taps.log")
    with open(folder.path / "answers") as answers:
        subprocess.run(["./stillcut", "tap", *QUESTION, "--hits", "3", "--bus", "log:taps.log", "--out", "sent"],
                       cwd=folder.path, stdin=answers, stdout=subprocess.DEVNULL, check=True)
    folder.in_guest(RUN)
    print("  ", *folder.text("tap.out").splitlines(), sep="\n   ")
    direction, = json.loads(folder.text("tap.json"))["postures"][0]["directions"]
    require((direction["axis"], direction["sense"], direction["hits_used"]) == ("y", -1, 2), f"{direction}")
    sent, heard = (hits_in(folder.path / where / "taps/home-y.uff") for where in ("sent", "taps"))
    require(len(sent) == 3 and len(heard) == 2, f"{len(sent)} hits sent, {len(heard)} kept")
    require(all(hit in sent for hit in heard), "what was heard on the bus is not what was sent")
    summary = folder.daemon_summary()
    require(summary["frames"] > 5000, f"the daemon heard only {summary['frames']} frames of the taps")
    require(summary["corrections"] == 0, "a daemon that measures corrects")


main({"guided": guided}, __doc__)
