#!/usr/bin/python3
"""decisions.py --here FOLDER --arm64 FOLDER --examples FOLDER [--recorded FOLDER]

The same log decided by the programs for this machine and by those for arm64, in QEMU: the same events at the same times,
of the same kinds, in the same words; frequencies, indicators and speeds within 1e-6. The logs are the recorded cut and
cuts that the programs for this machine simulate. --here and --arm64 are folders of programs that can be run.
Fails where arithmetic differs: a fused multiply-add in the monitor, another Fourier transform, a table of another libm.
"""
import argparse
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

NUMBERS = ("frequency_hz", "indicator", "spindle_speed_rpm")
WITHIN = 1e-6  # relative
# Name, cell, and what `stillcut simulate` is told: each with chatter but the last.
SIMULATED = [
    ("chatter", "demo-cell", ["--duration", "6", "--depth", "0:0,0.7:0,0.8:1.5,2:1.5,3:3.6,5.3:3.6,5.4:0"]),
    ("noisy", "demo-cell", ["--duration", "6", "--depth", "0:0,0.3:2,4.5:4.4,5.5:4.4,5.6:0", "--noise", "5", "--seed", "7"]),
    ("speed", "demo-cell", ["--duration", "6", "--depth", "0:0,0.3:3.6", "--speed", "0:8500,1:8500,5:7000"]),
    ("robot", "robot-cell", ["--duration", "12", "--depth", "0:0,1:0,1.2:2,10:12,11:0"]),
    ("sound", "demo-cell", ["--duration", "3", "--depth", "0:0,0.3:1,2.5:1,2.6:0"]),
]


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"decisions: {' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")


def events(programs, cell, log, file):
    run(programs / "stillcut", "replay", cell, "--can", log, "--events", file)
    with open(file, newline="") as rows:
        return list(csv.DictReader(rows))


def apart(a, b):
    """Relative difference of two numbers as written; both may be left out."""
    if a == b:
        return 0.0
    return abs(float(a) - float(b)) / max(abs(float(a)), abs(float(b))) if a and b else math.inf


def compare(name, here, arm64):
    """Says how far the two are apart; True: they agree."""
    story = lambda rows: [{key: text for key, text in row.items() if key not in NUMBERS} for row in rows]
    different = [(a, b) for a, b in zip(story(here), story(arm64)) if a != b]
    worst = {key: max((apart(a[key], b[key]) for a, b in zip(here, arm64)), default=0.0) for key in NUMBERS}
    agree = bool(here) and len(here) == len(arm64) and not different and max(worst.values()) <= WITHIN
    print(f"{'ok' if agree else 'DIFFERENT':9} {name:9} {len(here):3} events, {len(arm64)} for arm64; apart at most " +
          ", ".join(f"{key} {far:.1e}" for key, far in worst.items()))
    for a, b in different[:3]:
        print(f"    here  {a}\n    arm64 {b}")
    return agree


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--here", type=pathlib.Path, required=True)
    options.add_argument("--arm64", type=pathlib.Path, required=True)
    options.add_argument("--examples", type=pathlib.Path, required=True)
    options.add_argument("--recorded", type=pathlib.Path, help="folder of cell.toml and cut.log")
    options = options.parse_args()
    agree, chatter = [], 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        logs = [("recorded", options.recorded / "cell.toml", options.recorded / "cut.log")] if options.recorded else []
        for name, cell, words in SIMULATED:
            cell = options.examples / cell / "cell.toml"
            run(options.here / "stillcut", "simulate", cell, "--can", folder / f"{name}.log", *words)
            logs.append((name, cell, folder / f"{name}.log"))
        for name, cell, log in logs:
            here = events(options.here, cell, log, folder / "here.csv")
            agree.append(compare(name, here, events(options.arm64, cell, log, folder / "arm64.csv")))
            chatter += sum(row["event"] == "chatter_onset" for row in here)
    if chatter < len(logs) - 1:
        sys.exit(f"decisions: only {chatter} chatter onsets in {len(logs)} logs: they do not ask what they must")
    sys.exit(0 if all(agree) else "decisions: arm64 decides differently")


if __name__ == "__main__":
    main()
