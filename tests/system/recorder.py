#!/usr/bin/python3
"""What the recorder promises: a run with everything that goes wrong is decided again bit for bit, and a power cut loses
the last second at most.

faults: 20 s in closed loop, in real time, with the shipped kinds of faults; faults_long: ten minutes of them. power_cut,
power_cut_long: the daemon records on an ext4 disk in a guest that is killed at a random moment, twice, or twenty times
(--seed N: other moments). full_disk: it fills while the daemon records, and is emptied.
"""
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import time

from fault_scenario import PERIOD, fault_scenario
from scenario import HERE, main, require


def faults_of(seconds):
    def run(folder):
        cell = folder.path / "robot-cell"
        shutil.copytree(folder.examples / "robot-cell", cell)
        text = (cell / "cell.toml").read_text()
        (cell / "cell.toml").write_text(text.replace('mode = "shadow"', 'mode = "active"'))
        (cell / "faults-scenario.toml").write_text(fault_scenario(seconds))
        hil = json.loads(folder.stillcut("hil", "robot-cell/cell.toml", "--scenario", "robot-cell/faults-scenario.toml",
                                         "--record", "recording", "--json"))
        print("  ", hil)
        again = json.loads(folder.stillcut("replay", "robot-cell/cell.toml", "--can", "recording", "--json"))
        print("  ", again)
        size = sum(file.stat().st_size for file in (folder.path / "recording").iterdir())
        print(f"   {size / 1e6:.1f} MB, {len(list((folder.path / 'recording').glob('*.can.log.zst')))} segments")
        require(again["frames"] == hil["frames_sent"], f"{hil['frames_sent']} frames sent, {again['frames']} played back")
        require(again["recorded_outputs"] >= seconds / 2, "hardly anything was decided")
        require(again["recorded_outputs"] == again["replayed_outputs"] == again["same_outputs"],
                "the recording is decided otherwise")
        require(again["chatter_onsets"] >= seconds / (2 * PERIOD) and again["faults"] >= 3 * seconds / PERIOD,
                "chatter or faults are missing")
    return run


RECORD = """
mknod /run/ubd0 b 98 0 && mkdir /run/disk && mount -t ext4 /run/ubd0 /run/disk || fail "no disk"
record=/run/disk/recording start_daemon
canplayer -l i -I cut.log "vcan0=$(awk '{print $2; exit}' cut.log)" > canplayer.out 2>&1 &
until_true test -s /run/disk/recording/*.can.log.zst
while :; do alive; echo "sending $EPOCHREALTIME"; sleep 0.1; done
"""

RECOVER = """
mknod /run/ubd0 b 98 0 && mkdir /run/disk
e2fsck -p /run/ubd0 || [ $? = 1 ] || fail "fsck gives up"
mount -t ext4 -o ro /run/ubd0 /run/disk || fail "no disk"
rm -rf recovered
cp -r /run/disk/recording recovered && chmod -R a+rwX recovered
"""


FULL_DISK = """
mkdir /run/disk && mount -t tmpfs -o size=40m tmpfs /run/disk
head -c 41700000 /dev/zero > /run/disk/filler
record=/run/disk/recording start_daemon
canplayer -l i -I cut.log "vcan0=$(awk '{print $2; exit}' cut.log)" > canplayer.out 2>&1 &
until_true grep -q 'recording stopped' daemon.err
sleep 1
alive
rm /run/disk/filler
until_true grep -q 'recording goes on' daemon.err
sleep 2
stop_daemon
cp -r /run/disk/recording recovered && chmod -R a+rwX recovered
"""


def full_disk(folder):
    """It stops the recording, not the monitor, and says so once; with room it goes on in a new segment."""
    folder.in_guest(FULL_DISK)
    summary, said = folder.daemon_summary(), folder.text("daemon.err")
    print("  ", summary)
    require(said.count("recording stopped") == summary["record_stops"] == 1, "it is not said once")
    require("No space left on device" in said, "why it stopped is not said")
    require(summary["record_lost"] > 500, "what is lost is not counted")
    require(summary["record_dropped"] == 0, "the loop's ring was left to fill")
    segments = [json.loads(folder.stillcut("replay", "cell/live.toml", "--can", str(file), "--json"))["frames"]
                for file in sorted((folder.path / "recovered").glob("*.can.log.zst"))]
    print("   frames in the segments:", segments)
    require(len(segments) == 2 and min(segments) > 0, "no new segment with frames")
    require(sum(segments) < summary["frames"], "nothing is missing, so the disk was not full")


def kill_guest(runner):
    """Ends the kernel that run-in-uml, process `runner`, has started, as a power cut would: all of it at once."""
    sessions = {}  # of the processes that run a kernel, by process: parent's session, own session
    fields = lambda process: (process / "stat").read_text().rsplit(")", 1)[1].split()
    for process in pathlib.Path("/proc").iterdir():
        try:
            if os.readlink(process / "exe").endswith("/linux.uml"):
                parent, session = (int(fields(process)[i]) for i in (1, 3))
                sessions[int(process.name)] = int(fields(pathlib.Path(f"/proc/{parent}"))[3]), session
        except (OSError, ValueError, IndexError):
            continue  # no process, or one that has ended
    kernels = [process for process, (parents, _) in sessions.items() if parents == runner]
    require(len(kernels) == 1, f"{len(kernels)} kernels of this guest run")
    for process, (_, session) in sessions.items():
        if session == kernels[0]:
            os.kill(process, signal.SIGKILL)


def cut_power(folder, disk, after):
    """Records until the guest is killed `after` seconds from the first frames on; returns its last sign of life, up to 0.1 s
    before that by the clock that both kernels share: what this machine lets the guest stand still is not the recorder's loss."""
    guest = subprocess.Popen([HERE / "uml/run-in-uml", "-d", disk, "-t", "150", "--", "bash", "-c", ". ./guest.sh\n" + RECORD],
                             cwd=folder.path, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                             start_new_session=True)
    for line in guest.stdout:
        if line.startswith("sending"):
            break
    else:
        require(False, f"the guest ended by itself: {line}")
    time.sleep(after)
    kill_guest(guest.pid)
    signs = [line] + [line for line in guest.communicate()[0].splitlines() if re.fullmatch(r"sending \d+\.\d{6}", line)]
    return float(signs[-1].split()[1])


def power_cuts(times):
    def run(folder):
        moments = random.Random(folder.seed)
        disk = folder.path / "disk.img"
        worst = 0.0
        for i in range(times):
            disk.unlink(missing_ok=True)
            folder.run("truncate", "-s", "128M", disk)
            status, _, err = folder.run("mkfs.ext4", "-q", "-F", disk)
            require(status == 0, f"mkfs.ext4: {err}")
            disk.chmod(0o666)
            after = moments.uniform(1.0, 7.0)
            last_sign = cut_power(folder, disk, after)
            folder.in_guest(RECOVER, options=("-d", disk))
            again = json.loads(folder.stillcut("replay", "cell/live.toml", "--can", "recovered", "--json"))
            lost = 0.1 + last_sign - (again["start_utime"] * 1e-6 + again["signal_s"])
            worst = max(worst, lost)
            same = again["same_outputs"] == min(again["recorded_outputs"], again["replayed_outputs"])
            print(f"   cut {i + 1}: after {after:.2f} s; {again['frames']} frames back, lost the last {lost:.3f} s; "
                  f"{again['same_outputs']} of {again['recorded_outputs']} decisions again")
            require(again["frames"] > 500, "hardly anything was recorded")
            require(lost <= 1.0, f"the last {lost:.3f} s are lost")
            require(same, "what is left is decided otherwise")
        print(f"   worst of {times}: {worst:.3f} s")
    return run


main({"full_disk": full_disk, "power_cut": power_cuts(2), "power_cut_long": power_cuts(20),
      "faults": faults_of(20), "faults_long": faults_of(600)}, __doc__)
