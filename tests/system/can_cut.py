#!/usr/bin/python3
"""A cut on a real CAN bus: canplayer sends a log on vcan0, stillcutd decides, lcm-logger receives its messages over UDP.

What the daemon decided live must equal, byte for byte, the playback of what it recorded; and match the playback of the
original log, whose frames carry other stamps, in order and kind, to 5 ms and 0.5 Hz.
"""
import math

import lcm_log
from scenario import events_of, main, number, require, same_decisions

RUN = """
lcm-logger --quiet --force --lcm-url='udpm://239.255.76.67:7667?ttl=0' received.lcm > logger.out 2>&1 &
logger=$!
until_true test -e received.lcm
start_daemon
play cut.log
stop_daemon
sleep 0.5
kill -INT $logger
wait $logger
"""


def same_events(live, original):
    """The same story within 5 ms and 0.5 Hz."""
    names = lambda events: [(e["event"], e["kind"]) for e in events]
    require(names(live) == names(original), f"live {names(live)}, playback of the original {names(original)}")
    for a, b in zip(live, original):
        apart = abs(number(a["time_s"]) - number(b["time_s"]))
        require(apart <= 0.005, f"{a['event']} is {1e3 * apart:.2f} ms from the original's at {b['time_s']} s")
        fa, fb = number(a["frequency_hz"]), number(b["frequency_hz"])
        require(math.isnan(fa) == math.isnan(fb) and not abs(fa - fb) > 0.5, f"{a['event']}: {fa} Hz, original {fb} Hz")


def received_events_equal(received, events, start_us):
    """What came over LCM is what the events file says, in order."""
    require(len(received) == len(events), f"{len(received)} events received, {len(events)} decided")
    codes = {"cut_entry": 1, "cut_exit": 2, "chatter_onset": 3, "chatter_end": 4, "correction": 5, "fault": 6,
             "forced_vibration": 7}
    kinds = {"": 0, "unknown": 0, "regenerative": 1, "structural": 2}
    for message, event in zip(received, events):
        require((message.event, message.kind) == (codes[event["event"]], kinds[event["kind"]]), f"received {message.event}")
        require(message.utime - start_us == round(1e6 * number(event["time_s"])), f"stamp of {event['event']}")
        for name in ("frequency_hz", "indicator", "spindle_speed_rpm"):
            sent, written = getattr(message, name), number(event[name])
            require(math.isnan(sent) and math.isnan(written) or math.isclose(sent, written, rel_tol=1e-5, abs_tol=1e-5),
                    f"{event['event']}: {name} {sent} received, {written} in the events file")
        require(message.note == event["note"], f"note {message.note!r}")


def cut(folder):
    folder.in_guest(RUN)
    live = same_decisions(folder)
    summary = folder.daemon_summary()
    require(summary["frames_lost"] == summary["frames_bad"] == summary["kernel_dropped"] == 0, f"frames lost: {summary}")
    _, original = folder.replay("cut.log")
    same_events(live, events_of(original))
    require(any(e["event"] == "chatter_onset" for e in live), "no chatter was found")

    frames = [line for line in folder.text("record.log").splitlines() if line.startswith("(")]
    sent = folder.text("cut.log").splitlines()
    require([f.split()[2].split("##")[0] for f in frames] == [f.split()[2].split("##")[0] for f in sent],
            f"{len(sent)} frames sent, {len(frames)} recorded")
    start_us = round(1e6 * float(frames[0][1:frames[0].index(")")]))
    received = lcm_log.messages(folder.path / "received.lcm", lcm_log.message_classes(folder.path))
    received_events_equal(received["STILLCUT_EVENT"], live, start_us)
    corrections = received["STILLCUT_CORRECTION"]
    require(corrections, "no correction was received")
    require([c.sequence for c in corrections] == list(range(corrections[0].sequence, corrections[-1].sequence + 1)),
            "gaps in the corrections' sequence numbers")
    require(all(c.mode == 1 for c in corrections), "a correction asks to be followed, in a cell that is in shadow")
    require(all(c.valid_until_utime == c.utime + 1000 * c.valid_for_ms for c in corrections), "expiry of a correction")
    print(f"{len(frames)} frames, {len(live)} events, {len(corrections)} corrections, "
          f"{len(received['STILLCUT_STATUS'])} status messages")
    for event in live:
        print("  ", ", ".join(event.values()))


main({"cut": cut}, __doc__)
