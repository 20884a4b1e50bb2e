#!/usr/bin/python3
"""dds.py SCENARIO --programs FOLDER --peers FOLDER --cell FILE

stillcut-dds as a user starts it, on a network of its own where the kernel grants one (a network namespace), beside a
participant made with Cyclone DDS (dds_peer) and a stand-in for the daemon (telemetry_source).

hears: a Cyclone reader gets every sample of every type, once and with the members as they were told. speaks: `--listen`
hears a Cyclone writer of every type, and a second one. restarts: bridge and reader are killed and come back. cells: two
on one network, told apart by namespace and by partition. wrong_domain, discovery_server, shared_memory: as they say.
"""
import argparse
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

PATIENCE = 30  # s; what takes longer has failed
DOMAIN = 61
URL = "udpm://239.255.76.67:{port}?ttl=0"
TOPICS = ("status", "indicator", "spectrum", "vibration", "correction", "event", "lobes", "diagnostics")


def require(condition, what):
    if not condition:
        raise SystemExit(f"dds.py: {what}")


class Stage:
    """The processes of one scenario; what they write stands in files. All are ended with it."""

    def __init__(self, options, folder):
        self.options, self.folder, self.running, self.environment = options, pathlib.Path(folder), [], dict(os.environ)
        for name in ("ROS_DOMAIN_ID", "ROS_DISCOVERY_SERVER", "CYCLONEDDS_URI", "FASTRTPS_DEFAULT_PROFILES_FILE"):
            self.environment.pop(name, None)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in self.running:
            process.kill()
            process.wait()

    def start(self, *command):
        number = len(self.running)
        process = subprocess.Popen([str(word) for word in command], env=self.environment, cwd=self.folder,
                                   stdout=open(self.folder / f"{number}.out", "w"), stderr=open(self.folder / f"{number}.err", "w"))
        process.out, process.err = self.folder / f"{number}.out", self.folder / f"{number}.err"
        self.running.append(process)
        return process

    def bridge(self, *more, domain=DOMAIN, port=7668):
        return self.start(self.options.programs / "stillcut-dds", self.options.cell, "--domain", domain, "--lcm",
                          URL.format(port=port), *more)

    def listen(self, *more, domain=DOMAIN):
        return self.start(self.options.programs / "stillcut-dds", "--listen", "--domain", domain, *more)

    def source(self, seconds, port=7668, speed=9000):
        return self.start(self.options.peers / "telemetry_source", URL.format(port=port), seconds, speed)

    def peer(self, does="hear", name="stillcut", partition="-", speed=9000, count=""):
        return self.start(self.options.peers / "dds_peer", does, DOMAIN, name, partition, speed, count)

    def until(self, what, condition):
        end = time.monotonic() + PATIENCE
        while not condition():
            require(time.monotonic() < end, f"waited in vain for {what}" + self.said())
            time.sleep(0.02)

    def matched(self, peer, bridge, times=1, readers=len(TOPICS)):
        """The peer has met all writers (of so many bridges in turn), and the bridge all readers: no sample goes by."""
        self.until(f"the peer to meet all topics, {times} times", lambda: f"matched {times}\n" in peer.out.read_text())
        self.until(f"the bridge to meet {readers} readers",
                   lambda: re.findall(r"readers connected: (\d+)", bridge.err.read_text())[-1:] == [str(readers)])

    def end(self, process, send=signal.SIGTERM):
        """Asks it to end; returns what it wrote to standard output."""
        if process.poll() is None and send:
            process.send_signal(send)
        try:
            status = process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            raise SystemExit(f"dds.py: {process.args[0]} did not end" + self.said())
        require(status == 0 or send == signal.SIGKILL, f"{process.args[0]} ended with {status}" + self.said())
        return process.out.read_text()

    def said(self):
        return "".join(f"\n--- {pathlib.Path(process.args[0]).name}\n{process.err.read_text()[-600:]}{process.out.read_text()[-900:]}"
                       for process in self.running)

    def heard(self, peer):
        """Ends a hearing peer; {topic: counts}."""
        lines = [json.loads(line) for line in self.end(peer).splitlines() if line.startswith("{")]
        return {line.pop("topic"): line for line in lines}


def all_of_it(heard, sent, stage):
    """Every sample once, in order, every member as told."""
    for topic, count in sent.items():
        got = heard[topic]
        require(got == {"count": count, "first": 0, "last": count - 1, "missing": 0, "old": 0, "wrong": 0},
                f"{topic}: {count} were sent, heard was {got}" + stage.said())
    require(heard["diagnostics"]["count"] >= 1 and heard["diagnostics"]["wrong"] == 0, f"diagnostics: {heard['diagnostics']}")


def listed(out):
    """The last table of --listen: {topic: (messages, lost, newest)}."""
    rows = re.findall(r"^rt/(?:\S+/)?(\w+) +(\d+) messages +[\d.]+/s +(\d+) lost +\d+ writers  (.*)$", out, flags=re.M)
    return {topic: (int(messages), int(lost), newest) for topic, messages, lost, newest in rows[-len(TOPICS):]}


def hears(stage):
    bridge, peer = stage.bridge(), stage.peer()
    stage.matched(peer, bridge)
    sent = json.loads(stage.end(stage.source(8), None))
    time.sleep(0.5)
    heard = stage.heard(peer)
    all_of_it(heard, sent, stage)
    require(heard["diagnostics"]["missing"] <= 1, f"diagnostics: {heard['diagnostics']}")
    print(sent, heard["diagnostics"])


def speaks(stage):
    ear = stage.listen()
    count = 100
    for run in (1, 2):
        stage.end(stage.peer("speak", count=count), None)
        stage.until("all samples", lambda: all(listed(ear.out.read_text()).get(topic, (0,))[0] >= run * count for topic in TOPICS))
    last = listed(stage.end(ear))
    require(all((messages, lost) == (2 * count, 0) for messages, lost, _ in last.values()), f"not all, or not once: {last}")
    newest = {topic: words for topic, (_, _, words) in last.items()}
    require(newest == {"status": "cut, 9000 rpm, indicator 0.10, frames 99",
                       "indicator": "chatter, indicator 0.10, chatter at 724.8 Hz, margin 0.00",
                       "spectrum": "512 bins of 8.00 Hz, peak at 792.0 Hz",
                       "vibration": "tool: 99.000 0.000 0.000 m/s^2",
                       "correction": "number 99, kind 2, mode 2, 7600 rpm: reason 99",
                       "event": "event 3, kind 2, 724.8 Hz: note 99",
                       "lobes": "256 limits from 6000 to 14000 rpm, 0 modes",
                       "diagnostics": "peer: first (0): fine, peer: second (1): fine"}, f"in words: {newest}")


def restarts(stage):
    bridge, first = stage.bridge(), stage.peer()
    stage.matched(first, bridge)
    source = stage.source(8)
    time.sleep(1)
    stage.end(bridge, signal.SIGKILL)
    bridge = stage.bridge()
    stage.matched(first, bridge, times=2)
    second = stage.peer()
    stage.matched(second, bridge, readers=16)
    time.sleep(1)
    stage.end(second, signal.SIGKILL)
    third = stage.peer()
    stage.matched(third, bridge, readers=24)  # the second is missed when its lease ends, later
    sent = json.loads(stage.end(source, None))
    time.sleep(0.5)
    for name, peer in (("bridge", first), ("reader", third)):
        heard = stage.heard(peer)
        for topic, count in sent.items():
            got = heard[topic]
            require(got["last"] == count - 1 and got["old"] == 0 and got["wrong"] == 0,
                    f"after the {name}'s restart {topic}: {count} were sent, heard was {got}" + stage.said())
            require(got["missing"] == 0 if name == "reader" else 0 < got["count"] + got["missing"] <= count,
                    f"after the {name}'s restart {topic} misses some: {got}")
        print(name, heard["vibration"])


def cells(stage):
    bridges = [stage.bridge("--namespace", "left", port=7668), stage.bridge("--namespace", "right", "--partition", "hall", port=7669)]
    peers = [stage.peer(name="left", speed=8000), stage.peer(name="right", partition="hall", speed=7000)]
    outside = stage.peer(name="right", speed=7000)  # in no partition
    # All three hear the diagnostics of `left`, which has no partition: but the one in `hall`.
    for peer, bridge, readers in zip(peers, bridges, (len(TOPICS) + 1, len(TOPICS))):
        stage.matched(peer, bridge, readers=readers)
    lost = stage.listen("--namespace", "right", "--duration", 2)
    sources = [stage.source(2, port=7668, speed=8000), stage.source(3, port=7669, speed=7000)]
    sent = [json.loads(stage.end(source, None)) for source in sources]
    time.sleep(0.5)
    for peer, told in zip(peers, sent):
        all_of_it(stage.heard(peer), told, stage)
    heard = stage.heard(outside)
    require(all(heard[topic]["count"] == 0 for topic in sent[0]), f"heard across partitions: {heard}")
    stage.until("--listen", lambda: lost.poll() is not None)  # heard diagnostics at most: those of `left`
    require(all(messages == 0 for topic, (messages, _, _) in listed(lost.out.read_text()).items() if topic != "diagnostics"),
            "listening without partition heard the other cell")
    away = stage.listen("--namespace", "centre", "--partition", "attic", "--duration", 3)
    stage.until("--listen", lambda: away.poll() is not None)
    said = away.err.read_text()
    require(away.returncode == 4 and "Stillcut speaks elsewhere; listen with --namespace left, or --namespace right --partition hall" in said,
            f"ended with {away.returncode}: {said}")


def wrong_domain(stage):
    lonely = stage.bridge(port=7670, domain=DOMAIN + 2)  # its daemon comes late
    bridge, ear = stage.bridge(), stage.listen("--duration", 2, domain=DOMAIN + 1)
    stage.source(2)
    stage.until("--listen", lambda: ear.poll() is not None)
    said = ear.err.read_text()
    require(ear.returncode == 4 and said.count("\n") == 1 and f"nobody else is in DDS domain {DOMAIN + 1}" in said and
            "ROS_DOMAIN_ID" in said, f"ended with {ear.returncode}: {said}")
    stage.environment["ROS_DOMAIN_ID"] = str(DOMAIN)  # and found by the environment's
    ear = stage.start(stage.options.programs / "stillcut-dds", "--listen")
    stage.until("its readers", lambda: f"readers connected: {len(TOPICS)}\n" in bridge.err.read_text())
    stage.source(1)
    stage.until("a message", lambda: listed(ear.out.read_text()).get("status", (0,))[0] > 0)
    stage.end(ear)
    # Without a daemon the bridge says so, to people and in the diagnostics.
    ear = stage.listen(domain=DOMAIN + 2)
    stage.until("a warning", lambda: "is `stillcutd CELL` running" in lonely.err.read_text())
    stage.until("a stale level", lambda: "monitor (3): nothing is heard of the monitor" in ear.out.read_text())
    stage.source(1, port=7670)
    stage.until("word of the monitor", lambda: "the monitor is heard again" in lonely.err.read_text())


def discovery_server(stage):
    server = ("--discovery-server", "127.0.0.1:11888")
    bridge = stage.bridge(*server)
    stage.until("a warning", lambda: "the discovery server 127.0.0.1:11888 does not answer" in bridge.err.read_text())
    stage.start("fast-discovery-server", "-i", 0, "-l", "127.0.0.1", "-p", 11888)
    ear, other = stage.listen(*server), stage.listen()
    stage.until("all readers", lambda: f"readers connected: {len(TOPICS)}\n" in bridge.err.read_text())
    sent = json.loads(stage.end(stage.source(2), None))
    stage.until("all samples", lambda: all(listed(ear.out.read_text())[topic][0] == count for topic, count in sent.items()))
    require(all(lost == 0 for _, lost, _ in listed(stage.end(ear)).values()), "samples were lost")
    other.send_signal(signal.SIGTERM)
    require(other.wait(PATIENCE) == 4, "who does not ask the server has heard something")


def shared_memory(stage):
    def maps(process):
        return "/dev/shm/fastrtps" in pathlib.Path(f"/proc/{process.pid}/maps").read_text()
    bridge, plain = stage.bridge("--shared-memory"), stage.bridge("--namespace", "plain", port=7669)
    ear, beside = stage.listen("--shared-memory"), stage.peer()
    stage.matched(beside, bridge, readers=2 * len(TOPICS))
    sent = json.loads(stage.end(stage.source(2), None))
    stage.until("all samples", lambda: all(listed(ear.out.read_text())[topic][0] == count for topic, count in sent.items()))
    require(maps(bridge) and maps(ear) and not maps(plain), "shared memory is not as it was chosen")
    require(all(lost == 0 for _, lost, _ in listed(stage.end(ear)).values()), "samples were lost")
    all_of_it(stage.heard(beside), sent, stage)  # UDP goes on beside it


def in_own_network():
    """Starts this script anew in a network namespace whose only interface can multicast, where that is allowed."""
    if os.environ.get("STILLCUT_OWN_NETWORK"):
        return
    ready = "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo"
    unshare = ["unshare", "--net", "--map-root-user", "sh", "-c"]
    if subprocess.run([*unshare, ready], capture_output=True).returncode == 0:
        os.environ["STILLCUT_OWN_NETWORK"] = "1"
        os.execvp("unshare", [*unshare, ready + ' && exec "$0" "$@"', sys.executable, *sys.argv])
    print("no network of its own: on this host's")


def main():
    scenarios = {scenario.__name__: scenario for scenario in
                 (hears, speaks, restarts, cells, wrong_domain, discovery_server, shared_memory)}
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("scenario", choices=scenarios)
    for name in ("--programs", "--peers", "--cell"):
        options.add_argument(name, type=lambda text: pathlib.Path(text).resolve(), required=True)
    options = options.parse_args()
    in_own_network()
    with tempfile.TemporaryDirectory(prefix="stillcut-dds.") as folder, Stage(options, folder) as stage:
        scenarios[options.scenario](stage)
    print(f"{options.scenario}: ok")


main()
