"""Plays the monitor for one adapter and its simulated controller, both as programs, over real sockets and real LCM.

Runs in a folder with the programs, a cell (cell/live.toml) and the message classes (classes/): needs nothing else, and
speaks LCM's UDP form by itself. Leaves what it saw in peer.json.
"""
import collections
import csv
import json
import pathlib
import signal
import socket
import struct
import subprocess
import sys
import time

GROUP, PORT, MAGIC = "239.255.76.67", 7667, 0x4C433032
PATIENCE = 30  # s; what takes longer has failed


class Lcm:
    """Small messages of LCM over UDP multicast, on this host only."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        self.socket.bind((GROUP, PORT))
        membership = struct.pack("=4sl", socket.inet_aton(GROUP), socket.INADDR_ANY)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        self.socket.settimeout(0.02)
        self.number = 0
        self.heard = collections.defaultdict(list)

    def send(self, channel, message):
        self.number += 1
        self.socket.sendto(struct.pack(">II", MAGIC, self.number) + channel.encode() + b"\0" + message.encode(), (GROUP, PORT))

    def listen(self, seconds, classes):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                data = self.socket.recv(65536)
            except socket.timeout:
                continue
            magic, _ = struct.unpack_from(">II", data)
            channel, _, body = data[8:].partition(b"\0")
            if magic == MAGIC and channel.decode() in classes:
                self.heard[channel.decode()].append(classes[channel.decode()].decode(body))


class Monitor:
    def __init__(self, programs, asked):
        sys.path.insert(0, "classes")
        from stillcut import correction_ack_t, correction_t, robot_state_t
        self.correction_t = correction_t
        self.classes = {"ROBOT_STATE": robot_state_t, "ROBOT_ACK": correction_ack_t}
        self.lcm, self.sequence, self.asked = Lcm(), 0, pathlib.Path(asked)
        self.programs, self.running = programs, {}
        for name in programs:
            self.start(name)

    def start(self, name):
        self.running[name] = subprocess.Popen(self.programs[name], stderr=open(name + ".err", "a"))

    def correction(self, **fields):
        message = self.correction_t()
        self.sequence += 1
        message.utime, message.sequence = int(time.time() * 1e6), self.sequence
        message.valid_for_ms, message.mode, message.kind, message.feed_override = 500, 2, 1, 1.0
        for name, value in fields.items():
            setattr(message, name, value)
        self.lcm.send("STILLCUT_CORRECTION", message)

    def answers(self, accepted):
        return [ack for ack in self.lcm.heard["ROBOT_ACK"] if ack.accepted == accepted]

    def row(self):
        """What the controller was asked for in its last cycle."""
        lines = self.asked.read_text().split("\n")[:-1] if self.asked.exists() else []
        return next(csv.DictReader([lines[0], lines[-1]])) if len(lines) > 1 else {}

    def until(self, what, condition, repeat=None):
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise SystemExit(f"waited in vain for {what}; the controller's last row: {self.row()}")
            if repeat:
                self.correction(**repeat)
            self.lcm.listen(0.1, self.classes)

    def end(self, name):
        self.running[name].send_signal(signal.SIGTERM)
        return self.running[name].wait(PATIENCE)


def converse(programs, speed, feed):
    """The conversation that every adapter must be able to hold."""
    monitor = Monitor(programs, "asked.csv")
    adapter, controller = programs
    saw = {}
    try:
        monitor.until("a robot state", lambda: len(monitor.lcm.heard["ROBOT_STATE"]) > 20)
        asked = {"spindle_speed_rpm": speed, "spindle_speed_target_rpm": speed, "feed_override": feed}

        def reached():
            row = monitor.row()
            return row and abs(float(row["spindle_speed_rpm"]) - speed) < 0.006 * speed and \
                abs(float(row["feed_override"]) - feed) < 0.006
        monitor.until("speed and feed at the controller", reached, asked)
        saw["reached"] = monitor.row()
        saw["accepted"] = len(monitor.answers(1))
        monitor.correction(**asked, mode=1, kind=5)  # shadow: neither followed nor answered
        monitor.correction(**{**asked, "spindle_speed_rpm": 99999.0})
        monitor.until("a refusal", lambda: monitor.answers(0), None)
        saw["refused"] = monitor.answers(0)[0].reason

        def nominal():
            row = monitor.row()
            return float(row["spindle_change_rpm"]) == 0 and float(row["feed_override"]) == 1 and row["stopped"] == "0"
        monitor.until("the program's speed and feed", nominal)
        state = monitor.lcm.heard["ROBOT_STATE"][-1]
        saw["state"] = {name: getattr(state, name) for name in
                        ("spindle_speed_rpm", "feed_rate_m_per_s", "tcp_position_m", "axial_depth_m", "block")}
        saw["controller_exit"] = monitor.end(controller)
        monitor.lcm.listen(0.5, monitor.classes)
        monitor.lcm.heard.clear()
        monitor.lcm.listen(1.0, monitor.classes)
        saw["states_without_controller"] = len(monitor.lcm.heard["ROBOT_STATE"])
        monitor.asked.unlink()
        monitor.start(controller)  # and now the adapter ends first, in the middle of a correction
        monitor.until("speed and feed at the controller started again", reached, asked)
        saw["adapter_exit"] = monitor.end(adapter)
        monitor.until("the program's speed and feed after the adapter's end", nominal)
        saw["controller_exit"] |= monitor.end(controller)
    finally:
        for process in monitor.running.values():
            process.kill()
    pathlib.Path("peer.json").write_text(json.dumps(saw))


CONVERSATIONS = {
    "rsi": {"stillcut-rsi": ["./stillcut-rsi", "cell/live.toml", "--listen", "127.0.0.1:49152", "--cycle-ms", "12"],
            "stillcut-rsi-controller": ["./stillcut-rsi-controller", "--cycle-ms", "12", "--csv", "asked.csv"]},
    "egm": {"stillcut-egm": ["./stillcut-egm", "cell/live.toml", "--listen", "127.0.0.1:6510", "--cycle-ms", "12"],
            "stillcut-egm-controller": ["./stillcut-egm-controller", "--cycle-ms", "12", "--csv", "asked.csv"]},
    "linuxcnc": {"stillcut-linuxcnc": ["./stillcut-linuxcnc", "cell/live.toml", "--server", "127.0.0.1:5007"],
                 "stillcut-linuxcnc-controller": ["./stillcut-linuxcnc-controller", "--csv", "asked.csv"]},
}

if __name__ == "__main__":
    more = sys.argv[2:]  # further options of the adapter
    programs = {name: command + (more if number == 0 else [])
                for number, (name, command) in enumerate(CONVERSATIONS[sys.argv[1]].items())}
    converse(programs, 7380.0, 0.87)
