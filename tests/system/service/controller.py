"""Stands in for a robot's controller, in the guest: follows corrections as the contract says, by code that is not the
project's, and writes what it is set to, with the time (s, monotonic), each time that changes:

    12.345 corrected kind=1 rpm=7560
    13.100 nominal expired            or released, with the reason
"""
import sys
import time

sys.path[:0] = ["/test", "/test/classes"]
from adapter_peer import Lcm
from stillcut import correction_t

lcm, correction, expires, sequence, utime = Lcm(), None, 0.0, -1, 0


def now_set_to(what):
    print(f"{time.monotonic():.3f} {what}", flush=True)


while True:
    heard = lcm.heard["STILLCUT_CORRECTION"]
    heard.clear()
    lcm.listen(0.005, {"STILLCUT_CORRECTION": correction_t})
    for message in heard:
        started_anew = correction is None and message.utime > utime
        if message.mode != 2 or message.sequence <= sequence and not started_anew:
            continue
        sequence, utime, before = message.sequence, message.utime, correction
        correction, expires = message if message.kind else None, time.monotonic() + 1e-3 * message.valid_for_ms
        if not correction and (before or message.reason == "daemon ends"):  # the last word is owed in any case
            now_set_to(f"nominal released: {message.reason}")
        if correction and not before:
            now_set_to(f"corrected kind={message.kind} rpm={message.spindle_speed_target_rpm:.0f}")
    if correction and time.monotonic() > expires:
        correction = None
        now_set_to("nominal expired")
