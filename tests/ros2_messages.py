#!/usr/bin/python3
"""ros2_messages.py SOURCE [--self-test]

The ROS 2 package and the IDL say the same. Field by field, in order: each .msg file of ros2/stillcut_msgs against its struct
in drivers/dds/telemetry.idl, and the structs of ROS 2's own packages against their published definitions, copied below from
the documentation of their interfaces. Constants have the numbers of the C++ enumerations. --self-test spoils copies and
expects each to be found out.
"""
import pathlib
import re
import sys
import tempfile
import shutil

IDL_OF = {"bool": "boolean", "byte": "octet", "uint8": "octet", "int32": "long", "uint32": "unsigned long", "int64": "long long",
          "float32": "float", "float64": "double", "string": "string"}
# Types and names of the members, as the packages builtin_interfaces, std_msgs, geometry_msgs, sensor_msgs and
# diagnostic_msgs define them.
ROS2 = {
    "builtin_interfaces/Time": "int32 sec; uint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp; string frame_id",
    "geometry_msgs/Quaternion": "float64 x; float64 y; float64 z; float64 w",
    "geometry_msgs/Vector3": "float64 x; float64 y; float64 z",
    "sensor_msgs/Imu": "std_msgs/Header header; geometry_msgs/Quaternion orientation; float64[9] orientation_covariance; "
                       "geometry_msgs/Vector3 angular_velocity; float64[9] angular_velocity_covariance; "
                       "geometry_msgs/Vector3 linear_acceleration; float64[9] linear_acceleration_covariance",
    "diagnostic_msgs/KeyValue": "string key; string value",
    "diagnostic_msgs/DiagnosticStatus": "byte level; string name; string message; string hardware_id; diagnostic_msgs/KeyValue[] values",
    "diagnostic_msgs/DiagnosticArray": "std_msgs/Header header; diagnostic_msgs/DiagnosticStatus[] status",
}
# Constants of a message, by the enumeration that they repeat: (header, enumeration, first constant, last constant).
CONSTANTS = {
    "Status": [("dsp/signals.hpp", "State", "IDLE", "FAULT"), ("rt/signals.hpp", "RuntimeMode", "OFF", "ACTIVE")],
    "Indicator": [("dsp/signals.hpp", "ChatterKind", "UNKNOWN", "STRUCTURAL")],
    "Event": [("dsp/signals.hpp", "EventType", "CUT_ENTRY", "FORCED_VIBRATION")],
    "Correction": [("rt/signals.hpp", "CorrectionKind", "RELEASE", "STOP_REQUEST")],
}


def fail(what):
    raise SystemExit(f"ros2_messages.py: {what}")


def idl_type(ros):
    """A ROS 2 type in IDL."""
    base, array = re.fullmatch(r"([\w/]+)(\[\d*\])?", ros).groups()
    package, _, name = base.rpartition("/")
    base = f"{package}::msg::dds_::{name}_" if package else IDL_OF.get(base) or fail(f"{ros} is no type that is used here")
    if array == "[]":
        return f"sequence<{base}>"
    return base + (array or "")


def idl_structs(text):
    """{package/Name: [(type, member)]}"""
    text = re.sub(r"//.*", "", text)
    structs = {}
    for package, body in re.findall(r"module (\w+) \{ module msg \{ module dds_ \{(.*?)\}; \}; \};", text, flags=re.S):
        for final, name, members in re.findall(r"(@final )?struct (\w+)_ \{(.*?)\};", body, flags=re.S):
            if not final:
                fail(f"{name} in the IDL is not @final")
            structs[f"{package}/{name}"] = [
                (" ".join(kind.split()) + array, member)
                for kind, member, array in re.findall(r"([\w:<> ]+?)\s+(\w+)(\[\d+\])?;", members)]
    return structs


def message(text):
    """Fields [(type, member)] and constants {name: number} of a .msg file."""
    fields, constants = [], {}
    for line in text.splitlines():
        line = line.partition("#")[0].strip()
        if constant := re.fullmatch(r"u?int\d+ ([A-Z]\w*) = (\d+)", line):
            constants[constant[1]] = int(constant[2])
        elif field := re.fullmatch(r"(\S+) ([a-z]\w*)", line):
            fields.append((field[1], field[2]))
        elif line:
            fail(f"'{line}' is no field and no constant")
    return fields, constants


def enumerators(text, name):
    body = re.search(rf"enum class {name} : [\w:]+ \{{(.*?)\}}", text, flags=re.S)[1]
    return [(member.upper(), int(number)) for member, number in re.findall(r"(\w+) = (\d+)", body)]


def same(name, fields, struct):
    expected = [(idl_type(kind), member) for kind, member in fields]
    if struct != expected:
        apart = [f"{mine} and {theirs}" for mine, theirs in zip(expected, struct) if mine != theirs]
        fail(f"{name}: the message and the IDL differ: {apart or (len(expected), len(struct))}")


def check(source):
    structs = idl_structs((source / "drivers/dds/telemetry.idl").read_text())
    messages = {f"stillcut_msgs/{file.stem}": message(file.read_text()) for file in sorted((source / "ros2/stillcut_msgs/msg").glob("*.msg"))}
    published = {name: [tuple(field.split()) for field in fields.split("; ")] for name, fields in ROS2.items()}
    if set(structs) != set(messages) | set(published):
        fail(f"only one of IDL and messages has {set(structs) ^ (set(messages) | set(published))}")
    for name, (fields, constants) in messages.items():
        same(name, fields, structs[name])
        for header, enumeration, first, last in CONSTANTS.get(name.split("/")[1], []):
            names = list(constants)
            mine = [(key, constants[key]) for key in names[names.index(first):names.index(last) + 1]]
            theirs = enumerators((source / header).read_text(), enumeration)
            if mine != theirs:
                fail(f"{name}: {mine} is not {enumeration} of {header}, {theirs}")
    for name, fields in published.items():
        same(name, fields, structs[name])
    return len(structs)


def self_test(source):
    spoilt = [("drivers/dds/telemetry.idl", "double margin;", "float margin;"),
              ("drivers/dds/telemetry.idl", "    octet state;\n    octet mode;", "    octet mode;\n    octet state;"),
              ("drivers/dds/telemetry.idl", "  @final struct Event_", "  struct Event_"),
              ("drivers/dds/telemetry.idl", "    string key;\n", ""),
              ("drivers/dds/telemetry.idl", "orientation_covariance[9]", "orientation_covariance[6]"),
              ("ros2/stillcut_msgs/msg/Lobes.msg", "float32[] mode_hz\n", "float64[] mode_hz\n"),
              ("ros2/stillcut_msgs/msg/Event.msg", "string note\n", "string note\nuint8 more\n"),
              ("ros2/stillcut_msgs/msg/Status.msg", "uint8 CHATTER = 5", "uint8 CHATTER = 6"),
              ("rt/signals.hpp", "feed_direction = 3", "feed_direction = 9")]
    for file, old, new in spoilt:
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder)
            for part in ("drivers/dds", "ros2/stillcut_msgs/msg", "dsp", "rt"):
                shutil.copytree(source / part, copy / part)
            text = (copy / file).read_text()
            if text.count(old) < 1:
                fail(f"self-test: '{old}' is not in {file}")
            (copy / file).write_text(text.replace(old, new, 1))
            try:
                check(copy)
            except SystemExit:
                continue
            fail(f"self-test: '{new}' in {file} was not found out")
    return len(spoilt)


root = pathlib.Path(sys.argv[1])
print(f"{check(root)} types agree")
if "--self-test" in sys.argv:
    print(f"{self_test(root)} spoilt copies were found out")
