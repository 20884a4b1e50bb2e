#!/usr/bin/python3
"""A serial CAN adapter that is not there, for the guest: walks a real controller's states while stillcut doctor looks.

The kernel's slcan driver sits on one end of a pseudo terminal, this script plays the adapter's firmware on the other:
"sw100100" means error-warning with both error counters at 100. Classic CAN only.
"""
import fcntl
import json
import os
import pty
import struct
import subprocess
import threading
import time
import tty

TIOCSETD, N_SLCAN, SIOCGIFNAME = 0x5423, 17, 0x8910

adapter, line = pty.openpty()
tty.setraw(adapter)
tty.setraw(line)
fcntl.ioctl(line, TIOCSETD, struct.pack("i", N_SLCAN))
name = fcntl.ioctl(line, SIOCGIFNAME, b"\0" * 40).split(b"\0")[0].decode()


def swallow():  # somebody must read, or the interface does not come up
    while True:
        os.read(adapter, 4096)


threading.Thread(target=swallow, daemon=True).start()


def look(state):
    with open(state + ".json", "w") as out, open(state + ".err", "w") as err:
        status = subprocess.run(["./stillcut", "doctor", "--json", "--can", name], stdout=out, stderr=err).returncode
    with open(state + ".status", "w") as file:
        print(status, file=file)


subprocess.run(["ip", "link", "set", name, "type", "can", "bitrate", "500000"], check=True)
subprocess.run(["ip", "link", "set", name, "up"], check=True)
for said, state in (("sa000000", "active"), ("sw100100", "warning"), ("sp130130", "passive"),
                    ("sb256256", "bus_off")):
    os.write(adapter, said.encode() + b"\r")
    time.sleep(0.15)
    look(state)
with open("bus_off.json") as file:
    mend = [c["mend"] for c in json.load(file)["checks"] if c["name"] == name + " state"]
print(*mend)
subprocess.run(mend[0], shell=True, check=True)
look("bus_off_mended")
