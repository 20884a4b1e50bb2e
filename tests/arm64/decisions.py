#!/usr/bin/python3
"""decisions.py --here FOLDER --arm64 FOLDER --examples FOLDER [--recorded FOLDER]

The same log decided by the programs for this machine and by those for arm64, in QEMU: the same messages, event for event
and correction for correction, at the same times, of the same kinds, in the same words; numbers such as frequencies within
1e-6. The logs are the recorded cut and cuts that the programs for this machine simulate. --here and --arm64 are folders of
programs that can be run.
Fails where arithmetic differs: a fused multiply-add in the monitor, another Fourier transform, another libm.
"""
import argparse
import collections
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
import lcm_log

WITHIN = 1e-6  # relative
# Name, cell, and what `stillcut simulate` is told: each with chatter but the last.
SIMULATED = [
    ("chatter", "demo-cell", ["--duration", "6", "--depth", "0:0,0.7:0,0.8:1.5,2:1.5,3:3.6,5.3:3.6,5.4:0"]),
    ("noisy", "demo-cell", ["--duration", "6", "--depth", "0:0,0.3:2,4.5:4.4,5.5:4.4,5.6:0", "--noise", "5", "--seed", "7"]),
    ("speed", "demo-cell", ["--duration", "6", "--depth", "0:0,0.3:3.6", "--speed", "0:8500,1:8500,5:7000"]),
    ("robot", "robot-cell", ["--duration", "12", "--depth", "0:0,1:0,1.2:2,10:12,11:0"]),  # its sensor saturates
    ("sound", "demo-cell", ["--duration", "3", "--depth", "0:0,0.3:1,2.5:1,2.6:0"]),
]
CHATTER_ONSET = 3  # event_t.event


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"decisions: {' '.join(map(str, command))} ended with {done.returncode}: {done.stderr}")


def decided(programs, cell, log, file, classes):
    """{channel: [message, ...]} of what the daemon would publish of that log."""
    file.unlink(missing_ok=True)
    run(programs / "stillcut", "replay", cell, "--can", log, "--publish", f"file://{file}?mode=w")
    sent = collections.defaultdict(list, lcm_log.messages(file))
    return {channel: [classes[channel].decode(data) for data in sent[channel]]
            for channel in ("STILLCUT_EVENT", "STILLCUT_CORRECTION", "STILLCUT_STATUS")}


def fields(message):
    return {name: getattr(message, name) for name in message.__slots__}


def apart(a, b):
    """Relative difference of two numbers; infinite: of other things that are not the same."""
    if a == b or a != a and b != b:  # the same, or both no number
        return 0.0
    both = isinstance(a, float) and isinstance(b, float)
    return abs(a - b) / max(abs(a), abs(b)) if both and a == a and b == b else float("inf")


def compare(name, here, arm64):
    """Says how far the two are apart; True: they agree."""
    worst, shown = {}, []
    for channel in here:
        for a, b in zip(here[channel], arm64[channel]):
            far = {key: apart(x, y) for (key, x), y in zip(fields(a).items(), fields(b).values())}
            worst |= {key: max(x, worst.get(key, 0.0)) for key, x in far.items() if x > 0.0}
            if max(far.values()) > WITHIN:
                shown.append(f"    {channel} here  {fields(a)}\n    {channel} arm64 {fields(b)}")
    counts = lambda messages: [len(of_channel) for of_channel in messages.values()]
    agree = counts(here) == counts(arm64) and not shown
    events, corrections, states = counts(here)
    print(f"{'ok' if agree else 'DIFFERENT':9} {name:8} {events:3} events, {corrections:3} corrections, {states:3} states: " +
          (", ".join(f"{key} {far:.1e}" for key, far in worst.items()) + " apart" if worst else "bit for bit"))
    if counts(here) != counts(arm64):
        print(f"    here {counts(here)}, arm64 {counts(arm64)} of {', '.join(here)}")
    print(*shown[:3], sep="\n", end="\n" if shown else "")
    return agree


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--here", type=pathlib.Path, required=True)
    options.add_argument("--arm64", type=pathlib.Path, required=True)
    options.add_argument("--examples", type=pathlib.Path, required=True)
    options.add_argument("--recorded", type=pathlib.Path, help="folder of cell.toml and cut.log")
    options = options.parse_args()
    agree, onsets = [], 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        classes = lcm_log.message_classes(folder / "types")
        logs = [("recorded", options.recorded / "cell.toml", options.recorded / "cut.log")] if options.recorded else []
        for name, cell, words in SIMULATED:
            cell = options.examples / cell / "cell.toml"
            run(options.here / "stillcut", "simulate", cell, "--can", folder / f"{name}.log", *words)
            logs.append((name, cell, folder / f"{name}.log"))
        for name, cell, log in logs:
            here = decided(options.here, cell, log, folder / "here.lcm", classes)
            agree.append(compare(name, here, decided(options.arm64, cell, log, folder / "arm64.lcm", classes)))
            onsets += sum(event.event == CHATTER_ONSET for event in here["STILLCUT_EVENT"])
    if onsets < len(logs) - 1:
        sys.exit(f"decisions: only {onsets} chatter onsets in {len(logs)} logs: they do not ask what they must")
    sys.exit(0 if all(agree) else "decisions: arm64 decides differently")


if __name__ == "__main__":
    main()
