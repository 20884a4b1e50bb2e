"""What the system tests share: a folder that the guest kernel can use, runs in it, and readers of what came out.

A scenario copies the built programs and a cell into a fresh folder, runs one bash script inside User-mode Linux
(uml/run-in-uml; helpers of that script are in guest.sh), and then checks on the host what the daemon and its independent
listeners left there.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

# The simulated cut: air, entry, a sound cut, so deep that it chatters, exit (s:mm).
DEPTH = "0:0,0.7:0,0.8:1.5,2:1.5,3:3.6,5.3:3.6,5.4:0"
HERE = pathlib.Path(__file__).resolve().parent
MEMORY = "/dev/shm"


class Failed(Exception):
    """A scenario did not show what it must."""


def require(condition, what):
    if not condition:
        raise Failed(what)


def parse_arguments(description):
    options = argparse.ArgumentParser(description=description)
    options.add_argument("scenario")
    options.add_argument("--programs", type=pathlib.Path, required=True, help="folder of stillcut and stillcutd")
    options.add_argument("--cell", type=pathlib.Path, required=True, help="cell file whose folder is copied")
    options.add_argument("--log", type=pathlib.Path, help="candump log to play; default: a simulated cut")
    options.add_argument("--loop-audit", type=pathlib.Path, help="libloop_audit.so, to watch the daemon's loop with")
    options.add_argument("--seed", type=int, default=1, help="of what happens by chance")
    return options.parse_args()


class Folder:
    """A scratch folder with the programs, the guest's helpers, and a cell that listens to vcan0 as live.toml."""

    def __init__(self, options):
        self.seed = options.seed
        self.examples = options.cell.resolve().parent.parent
        # In memory: a busy disk would stop the guest's whole kernel at each write, for seconds.
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="stillcut-system.", dir=MEMORY if os.access(MEMORY, os.W_OK) else None))
        for file in (options.programs / "stillcut", options.programs / "stillcutd", HERE / "guest.sh"):
            shutil.copy(file, self.path)
        if options.loop_audit:
            shutil.copy(options.loop_audit, self.path)
        cell = self.path / "cell"
        shutil.copytree(options.cell.parent, cell)
        text = (cell / options.cell.name).read_text()
        text = re.sub(r'(?m)^bus = .*$', 'bus = "socketcan:vcan0"', text)
        if not options.log:  # the guest has one slow processor for sender, kernel and daemon: a slower sensor
            text = re.sub(r"(?m)^sample_rate_hz = .*$", "sample_rate_hz = 10000", text)
        (cell / "live.toml").write_text(text)
        if options.log:
            shutil.copy(options.log, self.path / "cut.log")
        else:
            self.stillcut("simulate", "cell/live.toml", "--duration", "6", "--depth", DEPTH, "--can", "cut.log")
        subprocess.run(["chmod", "-R", "a+rwX", self.path], check=True)  # the guest's kernel may run as nobody

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        if kind is Failed:
            for name in ("daemon.err", "daemon.out", "live.csv"):
                if (self.path / name).exists():
                    lines = (self.path / name).read_text(errors="replace").splitlines()
                    print(f"--- end of {name}", *lines[-15:], sep="\n")
        shutil.rmtree(self.path)

    def run(self, *command):
        result = subprocess.run([str(word) for word in command], cwd=self.path, capture_output=True, text=True)
        return result.returncode, result.stdout, result.stderr

    def stillcut(self, *words):
        status, out, err = self.run("./stillcut", *words)
        require(status == 0, f"stillcut {' '.join(words)} ended with {status}: {err}")
        return out

    def in_guest(self, script, seconds=150, options=()):
        status, out, err = self.run(HERE / "uml/run-in-uml", "-t", seconds, *options, "--", "bash", "-c", ". ./guest.sh\n" + script)
        print(out, err, sep="", end="")
        require(status == 0, f"the run in the guest ended with {status}")

    def replay(self, log):
        """Plays a log through `stillcut replay`; returns the text of the events file, and the LCM log of its messages."""
        name = self.path / log.replace(".log", ".replay")
        self.stillcut("replay", "cell/live.toml", "--can", log, "--events", f"{name}.csv", "--publish",
                      f"file://{name}.lcm?mode=w")
        return self.text(f"{name}.csv"), f"{name}.lcm"

    def daemon_summary(self):
        """The JSON object that stillcutd prints at its end."""
        return json.loads(self.text("daemon.out"))

    def text(self, name):
        require((self.path / name).exists(), f"{name} was not written")
        return (self.path / name).read_text()


def events_of(text):
    return list(csv.DictReader(text.splitlines()))


def same_decisions(folder):
    """What the daemon decided live equals the playback of what it recorded, byte for byte; returns the events.

    The live run also knows of the silence after the last frame, of which a recording can tell nothing: faults only, left out.
    """
    live = folder.text("live.csv")
    replayed, _ = folder.replay("record.log")
    require(live.startswith(replayed), f"live and playback of the recording differ:\n{live}\n{replayed}")
    events = events_of(replayed)
    after = [e for e in events_of(live)[len(events):] if e["event"] != "fault"]
    require(not after, f"decided after the last frame: {after}")
    return events


def frames_of(folder, log):
    return [line for line in folder.text(log).splitlines() if line.startswith("(")]


def stamps(frames):
    """Seconds since the first frame."""
    seconds = [float(line[1:line.index(")")]) for line in frames]
    return [s - seconds[0] for s in seconds]


def lateness(frames, sent):
    """Seconds by which each frame came later than the log says, seen from the first frame."""
    return [a - b for a, b in zip(stamps(frames), stamps(sent))]


def kept_waiting(folder, sent):
    """Whether this machine kept the guest waiting for 40 ms or more; from 50 ms on the daemon rightly calls samples lost."""
    late = lateness(frames_of(folder, "record.log"), frames_of(folder, sent))
    stall = max(late) - statistics.median(late)
    if stall >= 0.04:
        print(f"   this machine kept the guest waiting for {1e3 * stall:.0f} ms")
    return stall >= 0.04


def number(text):
    return float(text) if text else float("nan")


def main(scenarios, description):
    """Runs the scenario named on the command line; exit status 1 and one line where it fails."""
    options = parse_arguments(description)
    try:
        with Folder(options) as folder:
            scenarios[options.scenario](folder)
    except Failed as failure:
        sys.exit(f"FAILED {options.scenario}: {failure}")
    print(f"ok {options.scenario}")
