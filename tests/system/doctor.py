#!/usr/bin/python3
"""stillcut doctor on a real kernel: CAN interfaces and the multicast route are spoilt, told, and mended by its own commands."""
import json

from scenario import HERE, main, require

# Spoils, looks (NAME.json and its exit status), runs the commands printed for the checks named, looks again.
RUN = """
look() { ./stillcut doctor --json --can ${2:-vcan0} > $1.json 2> $1.err; echo $? > $1.status; }
mend() {  # mend NAME CHECK...: what doctor printed for these checks, word for word
  python3 -c 'import json, sys
for check in json.load(open(sys.argv[1]))["checks"]:
    if check["name"] in sys.argv[2:] and check["mend"]: print(check["mend"])' $1.json "${@:2}" > $1.sh || fail "$(cat $1.err)"
  cat $1.sh; sh $1.sh || fail "the commands of $1 end with $?"
}
look as_it_should_be
ip link set vcan0 down;                                     look down
mend down "vcan0 link";                                     look down_mended
ip link set vcan0 down; ip link set vcan0 mtu 16 up;        look mtu
mend mtu "vcan0 MTU";                                       look mtu_mended
ip route del 224.0.0.0/4 dev lo;                            look route
mend route "LCM route";                                     look route_mended
ip link set lo multicast off;                               look multicast
mend multicast "LCM interface";                             look multicast_mended
ip link del vcan0;                                          look gone
mend gone "CAN interface";                                  look gone_mended
ip route del 224.0.0.0/4 dev lo; ip link set lo multicast off; ip link set vcan0 down; ip link set vcan0 mtu 16
look all
mend all "vcan0 link" "vcan0 MTU" "LCM route" "LCM interface"; look all_mended
"""

# A serial adapter that is not there: a controller with bit rates and states, which vcan has not.
CONTROLLER = """
insmod /usr/lib/uml/modules/$(uname -r)/kernel/drivers/net/can/slcan/slcan.ko || fail "no slcan"
python3 ./serial_can.py || fail "serial_can.py"
"""

WATCHED = ("CAN interface", "vcan0 link", "vcan0 MTU", "LCM route", "LCM interface", "LCM loopback")

EXPECTED = {  # which of these checks are not ok
    "as_it_should_be": [],
    "down": ["vcan0 link"], "down_mended": [],
    "mtu": ["vcan0 MTU"], "mtu_mended": [],
    "route": ["LCM route"], "route_mended": [],
    "multicast": ["LCM interface"], "multicast_mended": [],
    "gone": ["CAN interface"], "gone_mended": [],
    "all": ["vcan0 MTU", "vcan0 link", "LCM route"], "all_mended": [],
}


def checks_of(folder, name):
    status = folder.text(name + ".status").strip()
    text = folder.text(name + ".json")
    require(status in ("0", "4") and text, f"{name}: doctor ended with {status}: {folder.text(name + '.err')}")
    answer = json.loads(text)
    require((status == "0") == all(c["ok"] for c in answer["checks"]), f"{name}: exit status {status} is not what it says")
    return {c["name"]: c for c in answer["checks"]}


def virtual(folder):
    folder.in_guest(RUN)
    for name, expected in EXPECTED.items():
        checks = checks_of(folder, name)
        bad = [c for c in checks if c in WATCHED and not checks[c]["ok"]]
        print("  ", name, {c: checks[c]["found"] for c in WATCHED if c in checks})
        require(sorted(bad) == sorted(expected), f"{name}: not ok are {bad}, not {expected}")
    # LCM itself agrees that route and interface are as they should be.
    loopback = checks_of(folder, "all_mended")["LCM loopback"]
    require(loopback["ok"] and loopback["applies"], f"LCM does not hear itself: {loopback}")


def controller(folder):
    (folder.path / "serial_can.py").write_text((HERE / "serial_can.py").read_text())
    folder.in_guest(CONTROLLER)
    expected = {"active": "error-active", "warning": "error-warning", "passive": "error-passive", "bus_off": "bus-off",
                "bus_off_mended": "error-active"}
    for name, state in expected.items():
        checks = {c.split(" ", 1)[1]: v for c, v in checks_of(folder, name).items() if c.startswith("can0 ")}
        told = {c: checks[c]["found"] for c in checks}
        print("  ", name, told)
        require(checks["bit rate"]["found"] == "500000 bit/s" and checks["bit rate"]["ok"], f"{name}: {told}")
        require(checks["link"]["ok"] and not checks["MTU"]["ok"], f"{name}: {told}")  # up; classic CAN only
        require(told["state"] == state and checks["state"]["ok"] == (state == "error-active"), f"{name}: {told}")
        require(not checks["error counters"]["applies"], f"{name}: {told}")  # slcan's driver does not tell them
        require(not checks["restart after bus-off"]["ok"], f"{name}: {told}")


main({"virtual": virtual, "controller": controller}, __doc__)
