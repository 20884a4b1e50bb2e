#!/usr/bin/python3
"""What `stillcut export --mcap` writes, read by the format's own reader (npm package @mcap/core): a recording of a closed loop
with corrections and acknowledgements holds the samples, events, corrections and robot messages that playback knows.

Needs node and npm, and the npm registry or its cache; mcap/package-lock.json names every package and its checksum.
"""
import csv
import json
import shutil

from scenario import HERE, main, require


def read_mcap(folder, file, begin, end):
    """All that the reader finds in the file; messages from begin to end (ns, both included) are counted by its index."""
    reader = folder.path / "reader"
    if not reader.exists():
        for tool in ("node", "npm"):
            require(shutil.which(tool), f"{tool} is missing: apt-get install nodejs npm")
        shutil.copytree(HERE / "mcap", reader)
        status, out, err = folder.run("npm", "ci", "--prefer-offline", "--no-audit", "--no-fund", "--prefix", reader)
        require(status == 0, f"npm ci: {out}{err}")
    status, out, err = folder.run("node", reader / "read.mjs", file, begin, end)
    require(status == 0, f"the reader refuses {file}: {err}")
    return json.loads(out)


def allowed(value, member):
    """Whether a value is of the type that the schema gives its member."""
    kinds = {"number": (int, float), "integer": int, "string": str, "boolean": bool, "array": list}
    return isinstance(value, kinds[member["type"]])


def mcap(folder):
    cell = folder.path / "cell/live.toml"
    cell.write_text(cell.read_text().replace('mode = "shadow"', 'mode = "active"'))
    scenario = (folder.examples / "scenarios/pocket-above.toml").read_text().replace("../demo-cell/cell.toml", "live.toml")
    (folder.path / "cell/run.toml").write_text(scenario)
    folder.stillcut("hil", "cell/live.toml", "--scenario", "cell/run.toml", "--record", "recording", "--json")
    recording = ("cell/live.toml", "--can", "recording")
    replayed = json.loads(folder.stillcut("replay", *recording, "--events", "events.csv", "--json"))
    told = json.loads(folder.stillcut("export", *recording, "--mcap", "cut.mcap", "--csv", "cut.csv", "--json"))
    print("  ", replayed, told, sep="\n   ")
    begin = replayed["start_utime"] * 1000
    window = (begin + 10**9, begin + 2 * 10**9 - 1)  # the second second
    found = read_mcap(folder, "cut.mcap", *window)
    counts = {topic: len(messages) for topic, messages in found["messages"].items()}
    print("  ", counts, f"{found['chunks']} chunks")

    require(found["statistics"] == counts and found["all"] == sum(counts.values()) == told["mcap_messages"],
            f"the statistics say {found['statistics']}")
    require(found["chunks"] > 1, "one chunk only: the index is not tried")
    in_window = {topic: sum(window[0] <= int(m["log_time_ns"]) <= window[1] for m in messages)
                 for topic, messages in found["messages"].items()}
    require(found["window"] == {topic: n for topic, n in in_window.items() if n > 0},
            f"by the index {found['window']}, from front to back {in_window}")
    for topic, messages in found["messages"].items():
        members = found["schemas"][found["topics"][topic]]["properties"]
        for message in messages:
            for name, value in message.items():
                require(name == "log_time_ns" or allowed(value, members[name]), f"{topic}: {name} = {value}")

    events = list(csv.DictReader((folder.path / "events.csv").open()))
    require([(e["event"], e.get("kind", ""), e.get("note", "")) for e in found["messages"]["/events"]] ==
            [(e["event"], e["kind"], e["note"]) for e in events], "the events are others than playback's")
    require(any(e["event"] == "correction" for e in events), "nothing was corrected")
    require(counts["/robot_ack"] > 0 and counts["/robot_state"] > 100, "the robot's messages are missing")
    sequences = {c["sequence"] for c in found["messages"]["/corrections"]}
    require({a["sequence"] for a in found["messages"]["/robot_ack"]} <= sequences, "corrections are missing")
    require(abs(counts["/status"] - 10 * replayed["signal_s"]) < 3, "status is not told ten times a second")

    rows = [row for row in csv.DictReader((folder.path / "cut.csv").open()) if row["x_m_per_s2"]]
    samples = [values for m in found["messages"]["/vibration/sensor_1"]
               for values in zip(m["x_m_per_s2"], m["y_m_per_s2"], m["z_m_per_s2"])]
    require(len(rows) == len(samples) == told["samples"], f"{len(rows)} rows of CSV, {len(samples)} samples of MCAP")
    require(all(tuple(float(row[f"{a}_m_per_s2"]) for a in "xyz") == sample for row, sample in zip(rows, samples)),
            "CSV and MCAP hold other samples")

    report = json.loads(folder.stillcut("report", *recording, "--out", "report.html", "--json"))
    onsets = [e["time_s"] for e in events if e["event"] == "chatter_onset"]  # a kind told later is no episode of its own
    reported = [f"{e['onset_s']:.6f}" for e in report["episodes"]]
    require(reported[0] == onsets[0] and set(reported) <= set(onsets), f"the report's onsets are {reported}, not {onsets}")
    answers = [c["answer"] for e in report["episodes"] for c in e["corrections"]]
    require("followed" in answers, f"no correction was followed: {answers}")
    require(report["latency_us"]["tick"]["count"] > 4000, f"the recording lacks the loop's times: {report['latency_us']}")
    print("  ", report["verdict"])

    folder.stillcut("export", *recording, "--mcap", "part.mcap", "--from", "1", "--to", "2")
    part = read_mcap(folder, "part.mcap", begin, begin + 10**10)
    require({t: n for t, n in part["statistics"].items() if "/v" not in t} ==
            {t: n for t, n in in_window.items() if "/v" not in t}, "an export of the window holds something else")
    damaged = bytearray((folder.path / "cut.mcap").read_bytes())
    damaged[len(damaged) // 3] ^= 0x10
    (folder.path / "damaged.mcap").write_bytes(damaged)
    refused, _, _ = folder.run("node", folder.path / "reader/read.mjs", "damaged.mcap", begin, begin)
    require(refused != 0, "the reader takes a damaged file: this test can find nothing")


main({"mcap": mcap}, __doc__)
