#!/usr/bin/python3
"""tests/bench/onlookers.py BUILD [--pairs 10] [--scenario FILE]

Does the loop notice that it is watched: ticks of the daemon on a simulated machine in real time, without telemetry,
recorder and onlookers, and with all of them (the page's server with a browser and seven streams, metrics, terminal, bridge
to DDS, recorder), in turn. Prints the ticks' times of both, their ratios with their spread, and what the onlookers cost.
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

WHAT = ("tick_p50_us", "wakeup_p50_us", "wakeup_p99_us", "tick_p9999_us", "tick_max_us")


def processor_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def run(programs, cell, scenario, *options):
    daemon = subprocess.Popen([programs / "stillcutd", cell, "--json", "--allow-not-real-time", *options],
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
    options = options.parse_args()
    programs = options.build.resolve()
    examples = pathlib.Path(__file__).resolve().parents[2] / "examples"
    scenario = examples / f"scenarios/{options.scenario}.toml"
    alone, watched, shares = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        cell = cell_in(folder, examples, "local:stillcut-onlookers-bench")
        for pair in range(options.pairs):
            alone.append(run(programs, cell, scenario, "--no-telemetry"))
            onlookers = Onlookers(programs, cell, browser=True)
            try:
                wait_until("metrics", lambda: urllib.request.urlopen(onlookers.url + "metrics").status == 200)
                before, started = processor_s(onlookers.scope.pid), time.monotonic()
                watched.append(run(programs, cell, scenario, "--record", folder / f"recording-{pair}"))
                shares.append((processor_s(onlookers.scope.pid) - before) / (time.monotonic() - started))
            finally:
                onlookers.end()
            print(f"pair {pair + 1}: tick p50 {alone[-1]['tick_p50_us']:.2f} us alone, {watched[-1]['tick_p50_us']:.2f} us "
                  "watched", flush=True)
    print(f"{'':16}{'alone':>10}{'watched':>10}   ratio (lowest to highest of the pairs)")
    for what in WHAT:
        ratios = [b[what] / a[what] for a, b in zip(alone, watched)]
        print(f"{what:16}{statistics.median(a[what] for a in alone):10.2f}{statistics.median(b[what] for b in watched):10.2f}"
              f"   {statistics.median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f})")
    print(f"the page's server, nine viewers: {100 * statistics.median(shares):.1f} % of a processor; "
          f"outputs dropped {sum(w['outputs_dropped'] for w in watched)}, recorded inputs dropped "
          f"{sum(w['record_dropped'] for w in watched)}")


if __name__ == "__main__":
    main()
