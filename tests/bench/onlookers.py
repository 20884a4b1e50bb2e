#!/usr/bin/python3
"""tests/bench/onlookers.py BUILD [--pairs 10] [--scenario FILE]

Does the loop notice that it is watched? A tick takes some microseconds, and how many depends on what the other processors
do (clock, caches, a virtual machine's host). So two daemons run, each on a simulated machine in real time, and all who look
on (the page's server with a browser and seven streams, metrics, terminal, bridge to DDS, recorder) watch one of them: the
machine bears the same in both turns, and what differs in the ticks of the first daemon is that it is watched. Before each
two turns it runs alone on an idle machine, without telemetry and recorder. Prints the ticks' times of all three, ratios with
their spread, and what the onlookers cost.

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
from onlookers import PORT, Onlookers, cell_in, wait_until  # noqa: E402

LOOP = -1  # its processor
WHAT = {"tick p50": lambda run: run["tick_p50_us"], "wake-up p50": lambda run: run["wakeup_p50_us"],
        "wake-up p99": lambda run: run["wakeup_p99_us"], "decision p50": lambda run: run["latency_us"]["decision"]["p50"],
        "tick p99.99": lambda run: run["tick_p9999_us"], "tick longest": lambda run: run["tick_max_us"]}


def processor_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def start(programs, cell, *options):
    return subprocess.Popen([programs / "stillcutd", cell, "--json", "--allow-not-real-time", *options],
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def run(programs, cell, scenario, *options, beside=None):
    """Ticks of a daemon in a scenario, another (its cell and options) in the same scenario beside it or not."""
    others = [start(programs, *beside)] if beside else []
    daemon = start(programs, cell, "--cpu", str(LOOP), *options)
    time.sleep(0.5)
    plants = [subprocess.Popen([programs / "stillcut", "plant", each, "--scenario", scenario], stdout=subprocess.DEVNULL)
              for each in [cell, *([beside[0]] if beside else [])]]
    if any([plant.wait() for plant in plants]):
        sys.exit("a simulated machine ended with an error")
    for each in [daemon, *others]:
        each.terminate()
    summary, *_ = [json.loads(each.communicate()[0]) for each in [daemon, *others]]
    return summary


def watched_run(programs, watched, run_it):
    """run_it() while all look at a cell. Its result, and the share of a processor that the page's server took."""
    onlookers = Onlookers(programs, watched, browser=True)
    try:
        wait_until("metrics", lambda: urllib.request.urlopen(onlookers.url + "metrics").status == 200)
        before, started = processor_s(onlookers.scope.pid), time.monotonic()
        result = run_it()
        return result, (processor_s(onlookers.scope.pid) - before) / (time.monotonic() - started)
    finally:
        onlookers.end()


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
    alone, beside, watched = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        cell = cell_in(folder, examples, "local:stillcut-onlookers-bench")
        (folder / "other").mkdir()
        other = cell_in(folder / "other", examples, "local:stillcut-onlookers-other")
        other.write_text(other.read_text().replace(str(PORT), str(PORT + 1)))
        for pair in range(options.pairs):
            records = "--record", folder / f"recording-{pair}"
            alone.append(run(programs, cell, scenario, "--no-telemetry"))
            turns = [lambda: beside.append(watched_run(programs, other, lambda: run(
                         programs, cell, scenario, "--no-telemetry", beside=(other, *records)))[0]),
                     lambda: watched.append(watched_run(programs, cell, lambda: run(
                         programs, cell, scenario, *records, beside=(other, "--no-telemetry"))))]
            for turn in turns if pair % 2 else reversed(turns):
                turn()
            print(f"round {pair + 1}: tick p50 {alone[-1]['tick_p50_us']:.2f} us alone, {beside[-1]['tick_p50_us']:.2f} us while "
                  f"the other is watched, {watched[-1][0]['tick_p50_us']:.2f} us watched", flush=True)
    watched, shares = zip(*watched)
    print(f"{'us':16}{'alone':>9}{'other':>9}{'watched':>9}   watched over other watched, over alone (lowest to highest)")
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
