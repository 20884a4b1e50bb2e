#!/usr/bin/python3
"""Onlookers change nothing: the page's server with a browser and seven streams, the terminal, the bridge to DDS, metrics
and the recorder, while some of them are killed, stopped, or flood the network and the server.

decisions: a recorded cut goes through the daemon in real time, alone and then with all of them: the same events and
corrections, byte for byte, the loop audited both times. closed_loop: daemon and machine in closed loop, with all of them:
what was recorded is decided again bit for bit.
"""
import argparse
import contextlib
import json
import os
import pathlib
import pty
import random
import re
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import threading
import time
import urllib.request

GROUP, PORT = "239.255.76.67", 7698
URL = f"udpm://{GROUP}:{PORT}?ttl=0"
STREAMS = 7


class Failed(Exception):
    pass


def require(condition, what):
    if not condition:
        raise Failed(what)


def wait_until(what, condition, seconds=20):
    end = time.monotonic() + seconds
    while not condition():
        require(time.monotonic() < end, f"{what}: waited {seconds} s in vain")
        time.sleep(0.05)


class Onlookers:
    """All who look on, each a process of its own, and the ways in which they misbehave."""

    def __init__(self, programs, cell, browser):
        self.programs, self.cell, self.processes, self.threads = programs, cell, [], []
        self.ending = threading.Event()
        self.streamed = [0] * STREAMS
        self.scope, self.url = self.start_scope()
        for stream in range(STREAMS):
            self.in_thread(self.follow, stream)
        if (programs / "stillcut-dds").exists():
            self.dds = self.start([programs / "stillcut-dds", cell], env={**os.environ, "ROS_DOMAIN_ID": "77"})
        if self.understands("top"):
            self.terminal, slave = pty.openpty()
            self.top = self.start([programs / "stillcut", "top", cell], stdin=slave, stdout=slave, stderr=slave,
                                  env={**os.environ, "TERM": "xterm-256color"})
            self.in_thread(self.drain_terminal)
        if browser:
            self.profile = tempfile.mkdtemp(prefix="stillcut-browser.")
            self.browser = self.start(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                                       f"--user-data-dir={self.profile}", "--remote-debugging-port=0", self.url],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_until("streams", lambda: min(self.streamed) > 0)

    def understands(self, command):
        return subprocess.run([self.programs / "stillcut", command, "--help"], capture_output=True).returncode == 0

    def start(self, command, **how):
        process = subprocess.Popen(list(map(str, command)), start_new_session=True, **how)
        self.processes.append(process)
        return process

    def start_scope(self):
        scope = self.start([self.programs / "stillcut", "scope", self.cell, "--port", "0", "--json"], stdout=subprocess.PIPE)
        return scope, json.loads(scope.stdout.readline())["url"]

    def in_thread(self, target, *arguments):
        thread = threading.Thread(target=target, args=arguments, daemon=True)
        thread.start()
        self.threads.append(thread)

    def follow(self, stream):
        while not self.ending.is_set():
            with contextlib.suppress(OSError), urllib.request.urlopen(self.url + "api/stream", timeout=5) as lines:
                for line in lines:
                    self.streamed[stream] += line.startswith(b"event:")
                    if self.ending.is_set():
                        break
            time.sleep(0.05)

    def drain_terminal(self):
        with contextlib.suppress(OSError):
            while os.read(self.terminal, 65536):
                pass

    def flood(self, seed):
        """Bytes that mean nothing on the channels of telemetry and robot, and requests that mean nothing, until the end."""
        rng = random.Random(seed)
        network = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        network.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        channels = ["STILLCUT_MONITOR", "STILLCUT_SPECTRUM", "STILLCUT_STATUS", "ROBOT_STATE", "ROBOT_ACK", "NOBODYS"]
        host, port = re.match(r"http://(.*):(\d+)/", self.url).groups()
        number = 0
        while not self.ending.is_set():
            for _ in range(20):
                number += 1
                channel = rng.choice(channels).encode()
                network.sendto(struct.pack(">II", 0x4C433032, number) + channel + b"\0" + rng.randbytes(rng.randrange(1400)),
                               (GROUP, PORT))
            with contextlib.suppress(OSError), socket.create_connection((host, int(port)), timeout=1) as connection:
                connection.sendall(rng.choice([b"GET /api/about HTTP/1.1\r\nHost: localhost\r\n\r\n", rng.randbytes(300),
                                               b"POST / HTTP/1.1\r\nContent-Length: 99999999\r\n\r\n"]))
            time.sleep(0.01)

    def misbehave(self):
        """One after the other while the cut goes on."""
        self.in_thread(self.flood, 1)
        for process in filter(None, [getattr(self, "dds", None), getattr(self, "top", None)]):
            process.send_signal(signal.SIGSTOP)
        time.sleep(1)
        self.scope.send_signal(signal.SIGSTOP)
        time.sleep(1)
        self.scope.send_signal(signal.SIGCONT)
        for process in filter(None, [getattr(self, "dds", None), getattr(self, "browser", None)]):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
        time.sleep(0.5)
        self.scope.kill()

    def end(self):
        self.ending.set()
        for process in self.processes:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        if hasattr(self, "profile"):
            shutil.rmtree(self.profile, ignore_errors=True)


def cell_in(folder, examples, bus, **changes):
    """A copy of the demo cell on an LCM network of its own."""
    cell = folder / "cell"
    if not cell.exists():
        shutil.copytree(examples / "demo-cell", cell)
    text = re.sub(r"(?m)^bus = .*$", f'bus = "{bus}"', (examples / "demo-cell/cell.toml").read_text())
    for old, new in changes.items():
        text = text.replace(old, new)
    text = re.sub(r"(?ms)^\[lcm\].*?(?=^\[|\Z)", "", text) + f'\n[lcm]\nurl = "{URL}"\n'
    (cell / "cell.toml").write_text(text)
    return cell / "cell.toml"


def decisions(programs, examples, folder, audit):
    log = folder / "cut.log"
    depth = "0:0,0.7:0,0.8:1.5,2:1.5,3:3.6,5.3:3.6,5.4:0"
    subprocess.run([programs / "stillcut", "simulate", examples / "demo-cell/cell.toml", "--duration", "6", "--depth", depth,
                    "--can", log], check=True)
    cell = cell_in(folder, examples, f"log:{log}")

    def run(name, *more):
        return subprocess.Popen([programs / "stillcutd", cell, "--events", folder / f"{name}.csv", "--record",
                                 folder / f"{name}-recording", "--audit", "--json", *more], stdout=subprocess.PIPE, text=True,
                                env={**os.environ, **({"LD_PRELOAD": str(audit)} if audit else {})}, stderr=subprocess.PIPE)

    def ended(daemon):
        out, err = daemon.communicate(timeout=60)
        require(daemon.returncode == 0, f"the daemon ended with {daemon.returncode}: {err[-500:]}")
        told = re.findall(r"loop_audit: .*", err)
        print("  ", *told)
        return json.loads(out)

    alone = ended(run("alone", "--no-telemetry"))
    onlookers = Onlookers(programs, cell, browser=True)
    try:
        daemon = run("watched")
        time.sleep(1)
        onlookers.misbehave()
        watched = ended(daemon)
        print("   events streamed:", onlookers.streamed)
    finally:
        onlookers.end()
    events = [(folder / f"{name}.csv").read_bytes() for name in ("alone", "watched")]
    require(events[0].count(b"chatter_onset") >= 1 and events[0].count(b"correction") >= 1, "nothing was decided")
    require(events[0] == events[1], "the decisions differ")
    require(alone["frames"] == watched["frames"], "the frames differ")
    for what in ("outputs_dropped", "record_dropped", "publish_failed"):
        require(watched[what] == 0, f"{what}: {watched[what]}")


def closed_loop(programs, examples, folder, audit):
    cell = cell_in(folder, examples, "local:stillcut-onlookers-test")
    shutil.copytree(examples / "scenarios", folder / "scenarios")
    onlookers = Onlookers(programs, cell, browser=False)
    try:
        hil = subprocess.Popen([programs / "stillcut", "hil", cell, "--scenario", examples / "scenarios/depth-step.toml",
                                "--live", "--audit", "--record", folder / "recording", "--json"], stdout=subprocess.PIPE)
        time.sleep(1)
        onlookers.misbehave()
        score = json.loads(hil.communicate(timeout=60)[0])
        print("  ", score)
    finally:
        onlookers.end()
    require(hil.returncode == 0, f"hil ended with {hil.returncode}")
    require(score["corrections"] >= 1, "no correction")
    active = cell_in(folder, examples, "local:x", **{'mode = "shadow"': 'mode = "active"'})
    again = json.loads(subprocess.run([programs / "stillcut", "replay", active, "--can", folder / "recording", "--json"],
                                      check=True, capture_output=True, text=True).stdout)
    print("  ", again)
    require(again["recorded_outputs"] == again["replayed_outputs"] == again["same_outputs"] > 0,
            "what was recorded is decided otherwise")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("scenario", choices=["decisions", "closed_loop"])
    options.add_argument("--programs", type=pathlib.Path, required=True, help="folder of stillcut and stillcutd")
    options.add_argument("--examples", type=pathlib.Path, required=True)
    options.add_argument("--loop-audit", type=pathlib.Path, help="libloop_audit.so, to count what the loop does with")
    options = options.parse_args()
    with tempfile.TemporaryDirectory(prefix="stillcut-onlookers.") as folder:
        try:
            globals()[options.scenario](options.programs, options.examples, pathlib.Path(folder), options.loop_audit)
        except Failed as failure:
            raise SystemExit(f"onlookers {options.scenario}: {failure}")
    print(f"onlookers {options.scenario}: ok")


if __name__ == "__main__":
    main()
