#!/usr/bin/python3
"""An adapter and its simulated controller as a user starts them, over real sockets and LCM, in the guest.

A correction reaches the controller as the right speed and feed and is acknowledged; one out of limits is refused with its
reason; shadow is not answered; when the messages stop the controller is back at its program; when the controller is
silent so is ROBOT_STATE.
"""
import json
import shutil

from adapter_peer import CONVERSATIONS
from lcm_log import message_classes
from scenario import HERE, main, parse_arguments, require


def conversation(name, adapter_programs):
    def run(folder):
        for program in CONVERSATIONS[name]:
            shutil.copy(adapter_programs / program, folder.path)
        shutil.copy(HERE / "adapter_peer.py", folder.path)
        message_classes(folder.path / "classes")
        folder.run("chmod", "-R", "a+rwX", ".")
        folder.in_guest(f"/usr/bin/python3 adapter_peer.py {name} || {{ tail -n 3 *.err; exit 1; }}")
        saw = json.loads(folder.text("peer.json"))
        print("  ", saw)
        for err in CONVERSATIONS[name]:
            print("  ", folder.text(err + ".err").splitlines()[-1])
        require(saw["accepted"] >= 1, "nothing was acknowledged")
        require(saw["refused"] == "spindle_speed_rpm is not from 6000 to 14000", f"refused because {saw['refused']}")
        require(saw["state"]["spindle_speed_rpm"] == 8500, "the state does not tell the programmed speed")
        require(abs(saw["state"]["feed_rate_m_per_s"] - 0.025) < 0.005, "the state does not tell the feed")
        require(saw["state"]["axial_depth_m"] != saw["state"]["axial_depth_m"], "the depth is not unknown")
        require(saw["states_without_controller"] == 0, "states went on without a controller")
        require(saw["adapter_exit"] == 0 and saw["controller_exit"] == 0, "a program did not end well")
    return run


programs = parse_arguments(__doc__).programs.resolve()
main({name: conversation(name, programs) for name in CONVERSATIONS}, __doc__)
