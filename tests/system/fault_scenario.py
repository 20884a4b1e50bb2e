"""A scenario for `stillcut hil` on the robot cell in which everything happens that can: chatter, moves of the arm, and each
fault of sensors, bus and controller.
"""

PERIOD = 20  # s


def fault_scenario(seconds):
    """The arm moves into chatter and back, and every kind of fault comes by in twenty seconds; again and again."""
    parts, depth = [], []
    for t in range(0, seconds, PERIOD):
        depth += [[t, 0], [t + 0.5, 0], [t + 0.7, 1.5], [t + 4, 1.5], [t + 4.2, 2.2], [t + 18.6, 2.2], [t + 18.8, 0]]
        for start, end, to in ((1.5, 3, "left"), (8, 9.5, "home")):
            parts.append(f'[[posture_move]]\nstart_s = {t + start}\nend_s = {t + end}\nto = "{to}"')
        for start, end, kind in ((5, 5.4, "silent"), (10, 11, "stuck"), (11.5, 12, "saturated"),
                                 (12.6, 13, "dead")):
            parts.append(f'[[sensor_fault]]\nstart_s = {t + start}\nend_s = {t + end}\nkind = "{kind}"')
        parts.append(f"[[lost_frames]]\nstart_s = {t + 6}\nend_s = {t + 8}\nrate = 0.02")
        parts.append(f"[[knock]]\ntime_s = {t + 13.5}\nimpulse_n_s = [0.05, 0.02, 0]")
    parts.append('[controller]\naccepts = ["spindle_speed", "speed_variation", "feed_override"]')  # a stop would end it all
    for t in range(0, seconds, PERIOD):
        for start, end, kind in ((6, 7, "refuses"), (14, 15, "silent"), (16, 16.5, "mute")):
            parts.append(f'[[controller.fault]]\nstart_s = {t + start}\nend_s = {t + end}\nkind = "{kind}"')
    head = (f'cell = "cell.toml"\ntitle = "All faults"\nduration_s = {seconds}\nseed = 5\nchatter = "expected"\n\n'
            f"[program]\naxial_depth_mm = {depth}\nspindle_speed_rpm = [[0, 3200]]\n\n")
    return head + "\n\n".join(parts) + "\n"
