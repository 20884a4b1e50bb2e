#!/usr/bin/python3
"""stillcut top, echo and hz in a real pseudo-terminal and over real LCM, in the guest.

top: shows that there is no daemon, then the daemon, then chatter; follows the terminal's size; help, pause, ^Z and back;
q gives the terminal back as it was. killed: so do signals. listen: echo and hz tell what an independent sender sends.
"""
import json
import shutil

from lcm_log import message_classes
from scenario import HERE, main, require


def seen(folder, what):
    for file in ("terminal_peer.py", "vt100.py", "adapter_peer.py"):
        shutil.copy(HERE / file, folder.path)
    message_classes(folder.path / "classes")
    folder.run("chmod", "-R", "a+rwX", ".")
    folder.in_guest(f"/usr/bin/python3 terminal_peer.py {what}")
    return json.loads(folder.text("terminal.json"))


def top(folder):
    saw = seen(folder, "top")
    print("  ", *saw["cut"], sep="\n   ")
    require(saw["says_how_to_start"], "without a daemon the screen does not say how to start it")
    require("chatter: regenerative chatter at 748.0 Hz" in saw["in_chatter"], f"chatter is shown as {saw['in_chatter']}")
    require(len(saw["cut"]) == 24, "the screen is not filled")
    require(any(line.startswith("Stability lobes") for line in saw["cut"]), "no lobes on the first page")
    require(80 < saw["wide"] <= 120, "the larger screen is not used")
    before, stopped, after = saw["terminal"]
    require(before == stopped, "while it is stopped the terminal is not as it was")
    require(before == after, "after q the terminal is not as it was")
    require((saw["once"], saw["json_state"]) != (0, "no daemon") and saw["once"] == 0, "--json did not hear the daemon")
    require(saw["once_alone"] == 4 and "stillcutd" in saw["once_says"], f"--once without a daemon: {saw['once_says']}")


def killed(folder):
    saw = seen(folder, "killed")
    print("  ", saw)
    for name, status in (("SIGTERM", 128 + 15), ("SIGINT", 0), ("SIGQUIT", 128 + 3), ("SIGTERM after ^S", 128 + 15)):
        end = saw[name]
        require(end["status"] == status, f"{name}: ended with {end['status']}")
        require(end["left_alternate_screen"] and end["cursor_shown"] and end["same"], f"{name}: the terminal is not as it was: {end}")


def listen(folder):
    saw = seen(folder, "listen")
    by_kind = {}
    for message in saw["echo"]:
        by_kind.setdefault((message["channel"], message["bytes"]), message)
    require(len(saw["echo"]) == 12 and len(by_kind) == 4, f"echo heard {list(by_kind)}")
    state = next(m for m in saw["echo"] if m["channel"] == "ROBOT_STATE" and m["bytes"] > 60)
    fields = state["fields"]
    require(state["type"] == "robot_state_t" and state["why_not"] is None, f"{state}")
    require((fields["utime"], fields["spindle_speed_rpm"], fields["axial_depth_m"]) == (42, 8500.5, "NaN"), f"{fields}")
    require(fields["tool_orientation_wxyz"] == [1, 0, 0, 0] and len(fields) == 11, f"{fields}")
    broken = by_kind["ROBOT_STATE", 60]
    require("end within" in broken["why_not"] and broken["fields"]["utime"] == 42, f"{broken}")
    other = by_kind["OTHER", 50]
    require(other["type"] is None and other["fingerprint"] == "0x" + "01" * 8, f"{other}")
    ack = next(m for m in saw["echo"] if m["channel"] == "ROBOT_ACK")
    require(ack["fields"]["reason"] == "too fast" and ack["fields"]["sequence"] == 7, f"{ack}")
    print(*saw["echo_text"], sep="\n")
    require(any("spindle_speed_rpm" in line and "8500.5" in line and "commanded" in line for line in saw["echo_text"]), "echo")
    channels = {channel["channel"]: channel for channel in saw["hz"]["channels"]}
    print("  ", saw["hz_rounds"], "rounds:", channels)
    require(set(channels) == {"ROBOT_STATE", "ROBOT_ACK", "OTHER"}, f"hz heard {list(channels)}")
    for name, size in saw["bytes"].items():
        heard = channels[name]
        require(0 < heard["messages"] <= saw["hz_rounds"], f"{name}: {heard} of {saw['hz_rounds']}")
        require(heard["bytes"] == size * heard["messages"], f"{name}: {heard} of {size} bytes each")
        require(heard["interval_min_ms"] <= heard["interval_mean_ms"] <= heard["interval_max_ms"], f"{name}: {heard}")


main({"top": top, "killed": killed, "listen": listen}, __doc__)
