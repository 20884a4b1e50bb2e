#!/usr/bin/python3
"""Every audit of the real-time loop at once, on the whole program at full load.

`stillcut hil` runs in real time for so many seconds: 25.6 kS/s of three axes (2560 CAN FD frames a second) and the robot's
messages in, chatter, moves of the arm, every fault; corrections that are followed, new lobes, status out; all of it
recorded. Its loop is watched by loop_audit (preloaded: heap, locks, page faults) and by --audit (system calls).
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from fault_scenario import PERIOD, fault_scenario  # noqa: E402


def parse_arguments():
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--programs", type=pathlib.Path, required=True, help="folder of stillcut")
    options.add_argument("--loop-audit", type=pathlib.Path, required=True, help="libloop_audit.so")
    options.add_argument("--examples", type=pathlib.Path, required=True, help="folder of robot-cell")
    options.add_argument("--seconds", type=int, required=True)
    return options.parse_args()


def require(condition, what):
    if not condition:
        sys.exit(f"closed_loop_audit: {what}")


def run(options, folder):
    shutil.copytree(options.examples / "robot-cell", folder / "cell")
    (folder / "cell/scenario.toml").write_text(fault_scenario(options.seconds))
    hil = subprocess.run(
        [options.programs / "stillcut", "hil", "cell/cell.toml", "--scenario", "cell/scenario.toml", "--record", "recording",
         "--events", "events.csv", "--audit", "--json"],
        cwd=folder, env={**os.environ, "LD_PRELOAD": str(options.loop_audit)}, capture_output=True, text=True)
    print(hil.stdout, hil.stderr, sep="")
    require(hil.returncode == 0, f"status {hil.returncode}")
    told = re.search(r"loop_audit: (.*) page faults .* in (\d+) sleeps", hil.stderr)
    require(told, "the loop was not audited")
    score, events = json.loads(hil.stdout), (folder / "events.csv").read_text()
    # That the run went where it must; what it must not do there has ended it already.
    require(int(told[2]) >= 500 * options.seconds, f"only {told[2]} ticks were watched")
    require(score["frames_sent"] >= 2300 * options.seconds, f"only {score['frames_sent']} frames were sent")
    require("chatter_onset" in events, "there was no chatter")
    require(events.count(",fault,") >= options.seconds / PERIOD, "there were no faults")
    require(score["corrections"] >= 1, "nothing was corrected")
    require(any((folder / "recording").glob("*.can.log.zst")), "nothing was recorded")
    print(f"closed_loop_audit: {told[2]} ticks, {score['frames_sent']} frames, {events.count('chatter_onset')} onsets, "
          f"{events.count(',fault,')} faults, {score['corrections']} corrections")


with tempfile.TemporaryDirectory(prefix="stillcut-audit.") as work:
    run(parse_arguments(), pathlib.Path(work))
