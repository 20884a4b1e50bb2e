"""Prints the corrections in an LCM log, releases and their reasons among them.

    python3 print-corrections.py LOG...     logs of lcm-logger, or of a recording (.lcm.log.zst, which needs zstdcat)
"""
import datetime
import struct
import subprocess
import sys

EVENT = struct.Struct(">IqqII")  # sync word, number, time, lengths of channel and data
CORRECTION = struct.Struct(">Qqqiqbb9dibi")  # fingerprint, then the fields of correction_t, last the length of the reason
KINDS = ["release", "spindle speed", "speed variation", "feed direction", "feed override", "stop"]


def messages(data, channel):
    at = 0
    while at + EVENT.size <= len(data):
        _, _, _, name, length = EVENT.unpack_from(data, at)
        at += EVENT.size + name
        if data[at - name:at] == channel:
            yield data[at:at + length]
        at += length


before = None
for file in sys.argv[1:] or sys.exit(__doc__):
    data = subprocess.run(["zstdcat", "-f", file], check=True, capture_output=True).stdout
    for message in messages(data, b"STILLCUT_CORRECTION"):
        _, utime, _, _, _, mode, kind, _, target, *_ = CORRECTION.unpack_from(message)
        told = ["", "shadow", "active"][mode], KINDS[kind], f"{target:.0f} rpm", message[CORRECTION.size:-1].decode()
        if told != before:  # a correction is said again while it holds
            print(datetime.datetime.fromtimestamp(utime / 1e6).time(), *told, sep="  ")
        before = told
