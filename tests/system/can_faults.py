#!/usr/bin/python3
"""What goes wrong on a real CAN bus while the daemon runs: it survives, counts and reports each, and ends cleanly.

One scenario a fault. Frames come from can-utils (canplayer, cansend, cangen), interfaces from iproute2. Whatever happened,
the playback of the daemon's recording must decide as the daemon did.
"""
from scenario import events_of, kept_waiting, main, number, require, same_decisions

INTERFACE_LOST = """
from_to cut.log 0 1.5 > first.log; from_to cut.log 2 3.5 > second.log; from_to cut.log 4 5 > third.log
start_daemon
play first.log
ip link set vcan0 down; sleep 0.5; alive; ip link set vcan0 up
play second.log
ip link del vcan0; sleep 0.5; alive; ip link add vcan0 type vcan; ip link set vcan0 mtu 72 up
until_true listening
play third.log
stop_daemon
"""

BUS_OFF = """
from_to cut.log 0 1.5 > first.log; from_to cut.log 1.5 3 > second.log
start_daemon
play first.log
cansend vcan0 20000004#0010000000000000   # controller: error passive, receiving
cansend vcan0 20000040#0000000000000000   # bus-off
sleep 0.3; alive
cansend vcan0 20000100#0000000000000000   # restarted
play second.log
stop_daemon
"""

LOST_FRAMES = """
awk -v id="$(sensor_id cut.log)" 'index($3, id "#") != 1 || ++n % 100 != 50' cut.log > thinned.log
start_daemon
play thinned.log
stop_daemon
"""

FLOOD = """
from_to cut.log 0 1.5 > first.log; from_to cut.log 1.5 3 > second.log; from_to cut.log 3 4.5 > third.log
id=$(sensor_id cut.log)
start_daemon
cangen vcan0 -g 0 -I 7F -L 8 -i -n 40000 &          # of other identifiers, as fast as the kernel takes them
foreign=$!
play first.log
kill $foreign 2> /dev/null; wait $foreign 2> /dev/null
alive
cangen vcan0 -g 0 -I $id -L 3 -D r -i -n 20000      # of the sensor's own identifier, too short
alive
play second.log
cangen vcan0 -g 1 -I $id -L 64 -f -D r -i -n 500    # and of the right length with random contents
alive
play third.log
stop_daemon
"""


def run(folder, script):
    """Runs the guest script; the daemon's events, its summary, and the frames it recorded."""
    folder.in_guest(script)
    events = same_decisions(folder)
    for event in events:
        print("  ", ", ".join(event.values()))
    summary = folder.daemon_summary()
    print("  ", summary)
    require(summary["outputs_dropped"] == 0 and summary["record_dropped"] == 0, "the daemon dropped its own output")
    return events, summary


def faults(events):
    return [e["note"] for e in events if e["event"] == "fault"]


def lines(folder, *names):
    return sum(len(folder.text(name).splitlines()) for name in names)


def silent_frames(folder):
    """Sensor frames of the cut that fall between the parts that were played."""
    sensor = [line for line in folder.text("cut.log").splitlines() if "##" in line]
    played = set("".join(folder.text(name) for name in ("first.log", "second.log", "third.log")).splitlines())
    last = max(i for i, line in enumerate(sensor) if line in played)
    return sum(line not in played for line in sensor[:last])


def interface_lost(folder):
    events, summary = run(folder, INTERFACE_LOST)
    require(summary["frames"] == lines(folder, "first.log", "second.log", "third.log"), "not every frame was heard")
    require(summary["frames_lost"] == silent_frames(folder), "frames sent while the interface was away are not counted")
    require(summary["reopened"] == 1, "the interface that came back was not opened once")
    require(sum("silent" in note for note in faults(events)) >= 2, f"each silence is a fault: {faults(events)}")


def bus_off(folder):
    events, summary = run(folder, BUS_OFF)
    require(summary["error_frames"] == 3 and summary["bus_off"] == 1, "error frames were not counted")
    require(sum("bus-off" in note for note in faults(events)) == 1, f"bus-off is one fault: {faults(events)}")
    require(any("error-passive" in note for note in faults(events)), f"error-passive is a fault: {faults(events)}")


def lost_frames(folder):
    events, summary = run(folder, LOST_FRAMES)
    lost = lines(folder, "cut.log") - lines(folder, "thinned.log")
    require(any("lost" in note for note in faults(events)), f"loss is a fault: {faults(events)}")
    require(lost >= 50 and summary["frames_lost"] >= lost, f"{lost} frames were left out, {summary['frames_lost']} counted")
    if kept_waiting(folder, "thinned.log"):  # then more is missing than was left out
        return
    require(summary["frames_lost"] == lost, f"{lost} frames were left out, {summary['frames_lost']} counted")
    whole, _ = folder.replay("cut.log")
    onset = next(e for e in events_of(whole) if e["event"] == "chatter_onset")
    found = [e for e in events if e["event"] == "chatter_onset"]
    require(found, "the chatter was missed")
    require(abs(number(found[0]["time_s"]) - number(onset["time_s"])) < 0.3 and
            abs(number(found[0]["frequency_hz"]) - number(onset["frequency_hz"])) < 10,
            f"first onset {found[0]}; without loss {onset}")


def flood(folder):
    events, summary = run(folder, FLOOD)
    require(summary["frames_bad"] + summary["kernel_dropped"] >= 20000, "the frames of the flood are not accounted for")
    require(faults(events), "the flood is no fault")


main({"interface_lost": interface_lost, "bus_off": bus_off, "lost_frames": lost_frames, "flood": flood}, __doc__)
