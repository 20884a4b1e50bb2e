#!/usr/bin/python3
"""A daemon that cannot start says why in one line, with the exit status of the contract: 2 usage, 3 input, 4 component."""
from scenario import main, require

RUN = """
sed 's/vcan0/vcan9/' cell/live.toml > cell/no_interface.toml
sed 's/^teeth = .*/teeth = "two"/' cell/live.toml > cell/bad_key.toml
sed 's/^dbc = .*/dbc = "none.dbc"/' cell/live.toml > cell/no_dbc.toml
attempt() { name=$1; shift; timeout 30 ./stillcutd "$@" > $name.out 2> $name.err; echo $? >> $name.out; }
attempt usage cell/live.toml --no-such-option
attempt no_cell cell/none.toml
attempt bad_key cell/bad_key.toml
attempt no_dbc cell/no_dbc.toml
attempt no_interface cell/no_interface.toml
sed 's/^mode = .*/mode = "active"/' cell/live.toml > cell/active.toml
attempt not_in_time cell/active.toml --cpu 63
attempt no_folder cell/live.toml --record none/record.log
ip route del 224.0.0.0/4
attempt no_route cell/live.toml
"""

EXPECTED = {  # exit status, and what the line must name
    "usage": (2, "--no-such-option"),
    "no_cell": (3, "cell/none.toml"),
    "bad_key": (3, "teeth"),
    "no_dbc": (3, "none.dbc"),
    "no_interface": (4, "vcan9"),
    "not_in_time": (4, "--allow-not-real-time"),  # no such processor
    "no_folder": (3, "none/record.log"),
    "no_route": (4, "ip route add"),
}


def refusals(folder):
    folder.in_guest(RUN)
    for name, (status, names) in EXPECTED.items():
        out, err = folder.text(name + ".out").split(), folder.text(name + ".err").splitlines()
        print("  ", name, out, err)
        require(out == [str(status)], f"{name}: ended with {out}, not {status}: {err}")
        require(err[-1].startswith("stillcutd: ") and names in err[-1], f"{name}: said {err}")
        require(len(err) == 1 or name == "no_route", f"{name}: said more than one line: {err}")  # liblcm talks there, too


main({"refusals": refusals}, __doc__)
