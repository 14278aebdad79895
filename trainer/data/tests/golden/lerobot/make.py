"""Writes data sets of LeRobot, v2.1 in degrees and v3.0 in radians, of a simulated arm of two servos, and episode 1 of v3.0 as CSV.

pip install numpy pyarrow; python3 make.py FOLDER

The arm hangs down at q = 0. Its numbers are those of `trainer/tests/cli_commands/lerobot.rs`, which learns them.
"""

import json
import pathlib
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

MASS, CENTRE, INERTIA, LENGTH, GRAVITY = [0.4, 0.25], [0.1, 0.08], [0.002, 0.001], 0.2, 9.81
STIFFNESS, DAMPING = np.array([3.0, 1.2]), np.array([0.35, 0.12])
FPS, FINE, FRAMES = 30, 40, [150, 140, 130]


def acceleration(q, v, u):
    """Of two links under gravity, by the torques k (u - q) - d v."""
    (m1, m2), (c1, c2), (i1, i2), l = MASS, CENTRE, INERTIA, LENGTH
    a, b = i1 + m1 * c1**2 + m2 * l**2, i2 + m2 * c2**2
    c = m2 * l * c2
    m = np.array([[a + b + 2 * c * np.cos(q[1]), b + c * np.cos(q[1])], [b + c * np.cos(q[1]), b]])
    s = c * np.sin(q[1])
    bias = np.array([-s * (2 * v[0] * v[1] + v[1] ** 2), s * v[0] ** 2])
    upper, lower = (m1 * c1 + m2 * l) * np.sin(q[0]), m2 * c2 * np.sin(q[0] + q[1])
    gravity = GRAVITY * np.array([upper + lower, lower])
    return np.linalg.solve(m, STIFFNESS * (u - q) - DAMPING * v - bias - gravity)


def goal(episode, k):
    """Goal positions at frame k, rad, as they are logged."""
    t = k / FPS
    wave = lambda w, phase: np.sin(w * t + phase + 1.3 * episode)
    return np.array([0.5 * wave(1.9, 0) + 0.4 * wave(5.1, 0), 0.6 * wave(2.6, 1) + 0.5 * wave(6.2, 2)]).astype(np.float32)


def motion(episode):
    """Positions and goals of an episode, rad; a goal is held from its frame to the next."""
    x, v, h = np.zeros(2), np.zeros(2), 1 / (FPS * FINE)
    positions, goals = [], []
    for k in range(FRAMES[episode]):
        u = goal(episode, k)
        positions.append(x.astype(np.float32))
        goals.append(u)
        u = u.astype(float)
        for _ in range(FINE):
            k1 = v, acceleration(x, v, u)
            k2 = v + h / 2 * k1[1], acceleration(x + h / 2 * k1[0], v + h / 2 * k1[1], u)
            k3 = v + h / 2 * k2[1], acceleration(x + h / 2 * k2[0], v + h / 2 * k2[1], u)
            k4 = v + h * k3[1], acceleration(x + h * k3[0], v + h * k3[1], u)
            x = x + h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
            v = v + h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
    return np.array(positions), np.array(goals)


def table(episodes, unit, vector):
    """Rows of these episodes."""
    parts = [motion(e) for e in episodes]
    frames = [FRAMES[e] for e in episodes]
    q, u = (unit(np.concatenate(part)) for part in zip(*parts))
    k = np.concatenate([np.arange(n) for n in frames])
    before = sum(FRAMES[: episodes[0]])
    column = lambda rows: pa.array(rows.tolist(), vector)
    return pa.table({
        "action": column(u),
        "observation.state": column(q),
        "timestamp": pa.array((k / FPS).astype(np.float32)),
        "frame_index": pa.array(k),
        "episode_index": pa.array(np.concatenate([np.full(n, e) for n, e in zip(frames, episodes)])),
        "index": pa.array(before + np.arange(len(k))),
        "task_index": pa.array(np.zeros(len(k), dtype=np.int64)),
    })


def write(folder, name, content, **options):
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(content, path, **options)


def describe(folder, version, names, data_path):
    vector = {"dtype": "float32", "shape": [2], "names": names}
    number = lambda dtype: {"dtype": dtype, "shape": [1], "names": None}
    info = {
        "codebase_version": version,
        "robot_type": "so101_follower",
        "total_episodes": len(FRAMES),
        "total_frames": sum(FRAMES),
        "chunks_size": 1000,
        "fps": FPS,
        "splits": {"train": f"0:{len(FRAMES)}"},
        "data_path": data_path,
        "features": {
            "action": vector,
            "observation.state": vector,
            "observation.images.front": {"dtype": "video", "shape": [48, 64, 3], "names": ["height", "width", "channels"]},
            "timestamp": number("float32"),
            **{name: number("int64") for name in ["frame_index", "episode_index", "index", "task_index"]},
        },
    }
    (folder / "meta").mkdir(parents=True, exist_ok=True)
    (folder / "meta/info.json").write_text(json.dumps(info, indent=1) + "\n")


folder = pathlib.Path(sys.argv[1])
of = folder / "v21"
describe(of, "v2.1", {"motors": ["main_shoulder_lift", "main_elbow_flex"]}, "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet")
for e in range(len(FRAMES)):
    degrees = lambda x: np.degrees(x.astype(float)).astype(np.float32)
    write(of, f"data/chunk-000/episode_{e:06d}.parquet", table([e], degrees, pa.list_(pa.float32())))
of = folder / "v30"
describe(of, "v3.0", ["shoulder_lift.pos", "elbow_flex.pos"], "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet")
radians = lambda x: x
for name, episodes in [("000", [0, 1]), ("001", [2])]:
    write(of, f"data/chunk-000/file-{name}.parquet", table(episodes, radians, pa.list_(pa.float32(), 2)), row_group_size=200)
rows = ["t,q0,q1,u0,u1"]
for k, (q, u) in enumerate(zip(*motion(1))):
    rows.append(",".join(repr(float(x)) for x in [np.float32(k / FPS), *q, *u]))
(folder / "episode1.csv").write_text("\n".join(rows) + "\n")
write(folder, "zstd.parquet", table([2], radians, pa.list_(pa.float32(), 2)), compression="zstd")
