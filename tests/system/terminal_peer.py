"""Uses `stillcut top`, `echo` and `hz` as a person at a terminal does: in a pseudo-terminal, with a daemon that comes and
goes, a simulated cut on vcan0, and messages over LCM's UDP form that this script encodes itself.

Runs in the guest, in a folder with the programs, a cell (cell/live.toml), a cut (cut.log) and the message classes
(classes/). Leaves what it saw in terminal.json; what it waits for and does not come ends it with an error.
"""
import contextlib
import fcntl
import json
import os
import pathlib
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import threading
import time

from adapter_peer import Lcm
from vt100 import Screen

PATIENCE = 60  # s; what takes longer has failed
DAEMON = ["./stillcutd", "cell/live.toml", "--allow-not-real-time"]

# A shell with job control: what it asks of the terminal before, while top is stopped, and after, must be the same.
SESSION = """
stty -g > before.tty
./stillcut top cell/live.toml
stty -g > stopped.tty
echo IS-STOPPED
read -r
fg > /dev/null
echo "ENDED-$?"
stty -g > after.tty
"""
KILLED = """
stty -g > before.tty
./stillcut top cell/live.toml
echo "KILLED-$?"
stty -g > after.tty
"""


class Session:
    """A script of bash in a pseudo-terminal of its own."""

    def __init__(self, script, terminal, columns, rows):
        self.screen, self.all = Screen(columns, rows), b""
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            os.environ.update(TERM=terminal, LANG="C.UTF-8")
            os.execvp("bash", ["bash", "-m", "-c", script])
        self.resize(columns, rows)

    def resize(self, columns, rows):
        self.screen.resize(columns, rows)
        fcntl.ioctl(self.fd, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def type(self, text):
        os.write(self.fd, text.encode())

    def read(self):
        """Takes what has come; False where nothing came for a moment: then the screen is drawn."""
        if not select.select([self.fd], [], [], 0.02)[0]:
            return False
        try:
            data = os.read(self.fd, 65536)
        except OSError:  # the other side is closed
            return False
        self.all += data
        self.screen.feed(data)
        return True

    def until(self, shown, what):
        """Reads until shown(text of the screen)."""
        end = time.monotonic() + PATIENCE
        while self.read() or not shown(self.screen.text()):
            if time.monotonic() > end:
                sys.exit(f"waited in vain for {what}; the screen is\n{self.screen.text()}")
        return self.screen.text()

    def until_said(self, words):
        self.until(lambda _: words in self.all, words)

    def end(self):
        while os.waitpid(self.pid, os.WNOHANG)[0] == 0:
            self.read()
        os.close(self.fd)


def state_is(*names):
    return lambda text: any(re.search(rf"(?m)^{name}: ", text) for name in names)


def pids_of_top():
    found = subprocess.run(["pgrep", "-f", "^./stillcut top"], capture_output=True, text=True).stdout
    return [int(pid) for pid in found.split()]


@contextlib.contextmanager
def telling_of_chatter():
    """Speaks for a daemon that hears chatter, twenty times a second."""
    sys.path.insert(0, "classes")
    from stillcut import monitor_t
    lcm, monitor, enough = Lcm(), monitor_t(), threading.Event()
    monitor.state, monitor.kind, monitor.chatter_frequency_hz, monitor.spindle_speed_rpm = 5, 1, 748.0, 8500.0

    def tell():
        while not enough.wait(0.05):
            lcm.send("STILLCUT_MONITOR", monitor)

    teller = threading.Thread(target=tell)
    teller.start()
    try:
        yield
    finally:
        enough.set()
        teller.join()


def top(saw):
    session = Session(SESSION, "vt100", 80, 24)
    alone = session.until(state_is("no daemon"), "the state without a daemon")
    saw["says_how_to_start"] = "stillcutd" in alone
    with telling_of_chatter():
        saw["in_chatter"] = session.until(state_is("chatter"), "chatter").splitlines()
    session.until(state_is("no daemon"), "silence")
    daemon = subprocess.Popen(DAEMON, stderr=subprocess.DEVNULL)
    session.until(lambda text: "mode shadow" in text and not state_is("no daemon")(text), "the daemon")
    # The guest's one slow processor may keep the loop from keeping time: what is asked is that the cut is heard.
    interface = pathlib.Path("cut.log").read_text().split()[1]
    player = subprocess.Popen(["chrt", "-f", "40", "canplayer", "-I", "cut.log", f"vcan0={interface}"])
    heard = session.until(lambda text: "Spectrum, accelerometer 1" in text and "8500 rpm" in text, "the cut")
    saw["cut"] = heard.splitlines()
    session.resize(120, 40)
    large = session.until(lambda text: text.count("\n") == 39 and "quit" in text.splitlines()[-1], "a larger screen")
    saw["wide"] = max(map(len, large.splitlines()))
    session.resize(40, 12)
    session.until(lambda text: "quit" in text.splitlines()[-1], "a smaller screen")
    session.type("?")
    session.until(lambda text: "q        quit" in text, "help")
    session.type("?p")
    session.until(lambda text: "PAUSED" in text, "the pause")
    session.type("p")
    session.until(lambda text: "PAUSED" not in text, "the end of the pause")
    session.type("\x1a")
    session.until_said(b"IS-STOPPED")
    session.type("\n")
    session.resize(80, 24)
    session.until(lambda text: "quit" in text.splitlines()[-1] and "spindle" in text, "the screen after a stop")
    once = subprocess.run(["./stillcut", "top", "cell/live.toml", "--json"], capture_output=True, text=True)
    saw["json_state"], saw["once"] = json.loads(once.stdout)["state"]["state"], once.returncode
    player.wait()
    daemon.send_signal(signal.SIGTERM)
    daemon.wait()
    session.until(state_is("no daemon"), "the end of the daemon")
    session.type("q")
    session.until_said(b"ENDED-0")
    session.end()
    saw["terminal"] = [pathlib.Path(f"{when}.tty").read_text() for when in ("before", "stopped", "after")]
    once = subprocess.run(["./stillcut", "top", "cell/live.toml", "--once"], capture_output=True, text=True)
    saw["once_alone"], saw["once_says"] = once.returncode, once.stderr


def killed(saw):
    for name, number in (("SIGTERM", signal.SIGTERM), ("SIGINT", signal.SIGINT), ("SIGQUIT", signal.SIGQUIT),
                         ("SIGTERM after ^S", signal.SIGTERM)):
        session = Session(KILLED, "xterm-256color", 80, 24)
        session.until_said(b"no daemon")
        before = len(session.all)
        if "^S" in name:
            session.type("\x13")
            time.sleep(0.5)  # redraws that find the terminal stopped
        for pid in pids_of_top():
            os.kill(pid, number)
        session.until_said(b"KILLED-")
        session.end()
        ended = int(re.search(rb"KILLED-(\d+)", session.all)[1])
        saw[name] = {"status": ended, "left_alternate_screen": b"\x1b[?1049l" in session.all[before:],
                     "cursor_shown": b"\x1b[?25h" in session.all[before:] or b"\x1b[?12l" in session.all[before:],
                     "same": pathlib.Path("before.tty").read_text() == pathlib.Path("after.tty").read_text()}


class Bytes:
    def __init__(self, data):
        self.data = data

    def encode(self):
        return self.data


def while_sending(lcm, messages, command):
    """Runs the command while `messages` are sent round after round; returns its lines and how many rounds were sent."""
    done, rounds = threading.Event(), 0
    program = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    watcher = threading.Thread(target=lambda: (program.wait(), done.set()))
    watcher.start()
    while not done.wait(0.01):
        for channel, message in messages:
            lcm.send(channel, message)
        rounds += 1
    watcher.join()
    return program.stdout.read().splitlines(), rounds


def listen(saw):
    sys.path.insert(0, "classes")
    from stillcut import correction_ack_t, robot_state_t
    lcm = Lcm()
    state, ack = robot_state_t(), correction_ack_t()
    state.utime, state.spindle_speed_rpm, state.axial_depth_m, state.tool_orientation_wxyz = 42, 8500.5, float("nan"), [1, 0, 0, 0]
    ack.sequence, ack.reason = 7, "too fast"
    messages = [("ROBOT_STATE", state), ("ROBOT_ACK", ack), ("OTHER", Bytes(b"\x01" * 50)),
                ("ROBOT_STATE", Bytes(state.encode()[:60]))]
    lines, _ = while_sending(lcm, messages, ["./stillcut", "echo", "ROBOT_.*", "OTHER", "--count", "12", "--json"])
    saw["echo"] = [json.loads(line) for line in lines]
    lines, _ = while_sending(lcm, messages[:1], ["./stillcut", "echo", "ROBOT_STATE", "--count", "1"])
    saw["echo_text"] = lines
    lines, rounds = while_sending(lcm, messages, ["./stillcut", "hz", "--duration", "3", "--json"])
    saw["hz"], saw["hz_rounds"] = json.loads(lines[-1]), rounds
    saw["bytes"] = {"ROBOT_ACK": len(ack.encode()), "OTHER": 50}


saw = {}
{"top": top, "killed": killed, "listen": listen}[sys.argv[1]](saw)
pathlib.Path("terminal.json").write_text(json.dumps(saw))
