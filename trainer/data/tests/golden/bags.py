"""Writes bag_0.db3, bag_1.db3 and metadata.yaml, as rosbag2 records a bag in two parts; pages are small, so that tables have many.

python3 bags.py FOLDER
"""

import pathlib
import sqlite3
import struct
import sys

JOINTS = ["a_joint_with_a_long_name", "b"]
START = 1_700_000_000_000_000_000


def text(body, value):
    count(body, len(value) + 1)
    body += value.encode() + b"\0"


def count(body, value):
    body += bytes(-len(body) % 4) + struct.pack("<I", value)


def message(stamp, fields, names, frame=""):
    body = bytearray(struct.pack("<iI", stamp // 10**9, stamp % 10**9))
    text(body, frame)
    count(body, len(names))
    for name in names:
        text(body, name)
    for field in fields:
        count(body, len(field))
        if field:
            body += bytes(-len(body) % 8)
        body += struct.pack(f"<{len(field)}d", *field)
    return b"\0\1\0\0" + bytes(body)


def write(path, samples):
    path.unlink(missing_ok=True)
    file = sqlite3.connect(path)
    file.execute("PRAGMA page_size = 512")
    file.execute(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,"
        "serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL)"
    )
    file.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT NULL)"
    )
    file.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    kinds = ["sensor_msgs/msg/JointState", "sensor_msgs/msg/Image", "sensor_msgs/msg/JointState"]
    for number, (name, kind) in enumerate(zip(["/joint_states", "/camera", "/commands"], kinds), 1):
        file.execute("INSERT INTO topics VALUES(?,?,?,'cdr','')", (number, name, kind))
    add = "INSERT INTO messages(topic_id,timestamp,data) VALUES(?,?,?)"
    for k in samples:
        now = START + k * 10**7
        values = [[0.25 * k, -k], [1.5, 2.0 * k], []]
        # Frames of growing length take messages across the edge of a page.
        file.execute(add, (1, now + 10**6, message(now, values, JOINTS, "f" * (80 * k))))
        file.execute(add, (3, now + 10**6, message(now, [[], [], [10.0 + k]], JOINTS[:1])))
    file.execute(add, (2, now, bytes(700)))
    file.commit()
    file.close()


folder = pathlib.Path(sys.argv[1])
write(folder / "bag_1.db3", range(5, 10))
write(folder / "bag_0.db3", range(5))
(folder / "metadata.yaml").write_text(
    "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - bag_0.db3\n    - bag_1.db3\n  message_count: 22\n"
)
