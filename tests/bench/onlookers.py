#!/usr/bin/python3
"""tests/bench/onlookers.py BUILD [--pairs 10] [--scenario FILE]

Does the loop notice that it is watched: ticks of the daemon on a simulated machine in real time, without telemetry,
recorder and onlookers, the same beside a process that only turns, and with all of them (the page's server with a browser
and seven streams, metrics, terminal, bridge to DDS, recorder), in turn. A tick takes some microseconds, and how many depends
on what the other processors do (clock, caches, a virtual machine's host): the middle run tells that apart from the onlookers.
Prints the ticks' times of all three, ratios with their spread, and what the onlookers cost.

The loop has the last processor to itself, as the handbook asks for, all else is on the others (--shared: it is not so).
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "system"))
from onlookers import Onlookers, cell_in, wait_until  # noqa: E402

LOOP = -1  # its processor
WHAT = {"tick p50": lambda run: run["tick_p50_us"], "wake-up p50": lambda run: run["wakeup_p50_us"],
        "wake-up p99": lambda run: run["wakeup_p99_us"], "decision p50": lambda run: run["latency_us"]["decision"]["p50"],
        "tick p99.99": lambda run: run["tick_p9999_us"], "tick longest": lambda run: run["tick_max_us"]}


def processor_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run(programs, cell, scenario, *options):
    daemon = subprocess.Popen([programs / "stillcutd", cell, "--json", "--allow-not-real-time", "--cpu", str(LOOP), *options],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    time.sleep(0.5)
    subprocess.run([programs / "stillcut", "plant", cell, "--scenario", scenario], check=True, stdout=subprocess.DEVNULL)
    daemon.terminate()
    return json.loads(daemon.communicate()[0])


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("build", type=pathlib.Path)
    options.add_argument("--pairs", type=int, default=10)
    options.add_argument("--scenario", default="depth-step")
    options.add_argument("--shared", action="store_true", help="the loop goes where the kernel puts it")
    options = options.parse_args()
    processors = sorted(os.sched_getaffinity(0))
    if not options.shared and len(processors) > 1:
        global LOOP
        LOOP = processors[-1]
        os.sched_setaffinity(0, processors[:-1])  # of this process and all that it starts; the loop moves itself
    programs = options.build.resolve()
    examples = pathlib.Path(__file__).resolve().parents[2] / "examples"
    scenario = examples / f"scenarios/{options.scenario}.toml"
    alone, beside, watched, shares = [], [], [], []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        cell = cell_in(folder, examples, "local:stillcut-onlookers-bench")
        for pair in range(options.pairs):
            alone.append(run(programs, cell, scenario, "--no-telemetry"))
            turning = subprocess.Popen(["nice", "-n", "19", "sh", "-c", "while :; do :; done"])
            beside.append(run(programs, cell, scenario, "--no-telemetry"))
            turning.kill()
            turning.wait()
            onlookers = Onlookers(programs, cell, browser=True)
            try:
                wait_until("metrics", lambda: urllib.request.urlopen(onlookers.url + "metrics").status == 200)
                before, started = processor_s(onlookers.scope.pid), time.monotonic()
                watched.append(run(programs, cell, scenario, "--record", folder / f"recording-{pair}"))
                shares.append((processor_s(onlookers.scope.pid) - before) / (time.monotonic() - started))
            finally:
                onlookers.end()
            print(f"round {pair + 1}: tick p50 {alone[-1]['tick_p50_us']:.2f} us alone, {beside[-1]['tick_p50_us']:.2f} us beside "
                  f"another process, {watched[-1]['tick_p50_us']:.2f} us watched", flush=True)
    print(f"{'us':16}{'alone':>9}{'beside':>9}{'watched':>9}   watched over beside, over alone (lowest to highest)")
    for what, of in WHAT.items():
        runs = [[of(one) for one in each] for each in (alone, beside, watched)]
        print(f"{what:16}" + "".join(f"{statistics.median(each):9.2f}" for each in runs), end="")
        for base in (1, 0):
            ratios = [w / b for w, b in zip(runs[2], runs[base])]
            print(f"   {statistics.median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f})", end="")
        print()
    print(f"the page's server, nine viewers: {100 * statistics.median(shares):.1f} % of a processor; "
          f"outputs dropped {sum(w['outputs_dropped'] for w in watched)}, recorded inputs dropped "
          f"{sum(w['record_dropped'] for w in watched)}")


if __name__ == "__main__":
    main()
