"""The double pendulum of RealAIGym swings up from hanging and stays up: python acrobot.py [acrobot | pendubot]

`Anywhere` has the interface of the controllers of DFKI's `double_pendulum`, and is one if that package is installed.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import leastaction as la

try:
    from double_pendulum.controller.abstract_controller import AbstractController
except ImportError:
    AbstractController = object

# Design C.1, model 1.0 of the competition: two links without rotors and friction; inertias about the joints.
MASS = [0.5234602302310271, 0.6255677234174437]  # kg
LENGTH = [0.2, 0.3]  # m
CENTRE = [0.2, 0.25569305436052964]  # m
INERTIA = [0.031887199591513114, 0.05086984812807257]  # kg m²
GRAVITY = 9.81  # m/s²
TORQUE_LIMIT = 6.0  # N m
TICK = 0.002  # s

CONFIG = {
    "tick": TICK,
    "ticks_per_node": 5,
    "seconds": 2.0,
    "start": [0.0, 0.0],
    "goal": [np.pi, 0.0],
    "cost": {"u": [0.01, 0.01]},
    "follow": {"q": [1.0, 1.0], "v": [3.0, 3.0], "u": [1.0, 1.0]},
    "policy": {"starts": 128, "q": [0.1, 0.2], "v": [0.5, 1.0]},
}


def description():
    """The robot description (URDF); q = 0 hangs, and q₂ is relative to link 1."""
    parts = ['<robot name="double_pendulum"><link name="base"/>']
    for k, (parent, below) in enumerate([("base", 0.0), ("link0", LENGTH[0])]):
        about = INERTIA[k] - MASS[k] * CENTRE[k] ** 2  # about the centre of mass
        parts.append(
            f'<link name="link{k}"><inertial><origin xyz="0 0 {-CENTRE[k]}"/><mass value="{MASS[k]}"/>'
            f'<inertia ixx="{about}" iyy="{about}" izz="{about}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            f'<joint name="joint{k}" type="continuous"><parent link="{parent}"/><child link="link{k}"/>'
            f'<origin xyz="0 0 {-below}"/><axis xyz="0 1 0"/></joint>'
        )
    return "".join(parts) + "</robot>"


class Anywhere(AbstractController):
    """Upright from anywhere, in as little time as the drive allows, and again after every disturbance.

    robot  "acrobot" (the second joint is driven) or "pendubot" (the first)
    keys   more for `la.Controller`, such as other keys of the configuration
    """

    def __init__(self, robot="acrobot", **keys):
        super().__init__()
        limits = {"acrobot": [0.0, TORQUE_LIMIT], "pendubot": [TORQUE_LIMIT, 0.0]}[robot]
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "double_pendulum.urdf")
            file.write_text(description())
            self.controller = la.Controller(file, {**CONFIG, "limits": {"u": limits}}, **keys)

    def init_(self):
        """Called before a run."""
        self.controller.reset()

    def reset_(self):
        """Called after a run."""
        self.controller.reset()

    def get_control_output_(self, x, t=None):
        """Torques of both joints, N m, for x = [q₁, q₂, v₁, v₂] (rad, rad/s) at the time t (s)."""
        return self.controller(x[:2], x[2:], t)


def rate(x, tau):
    """ẋ of the double pendulum under the torques of both joints."""
    (q1, q2, v1, v2), (r1, r2), (m1, m2), (i1, i2), l1 = x, CENTRE, MASS, INERTIA, LENGTH[0]
    coupling = m2 * l1 * r2
    m12 = i2 + coupling * np.cos(q2)
    mass = np.array([[i1 + m2 * l1**2 + 2 * m12 - i2, m12], [m12, i2]])
    coriolis = coupling * np.sin(q2) * np.array([-v2 * (2 * v1 + v2), v1 * v1])
    second = GRAVITY * m2 * r2 * np.sin(q1 + q2)
    gravity = np.array([GRAVITY * (m1 * r1 + m2 * l1) * np.sin(q1) + second, second])
    return np.concatenate([x[2:], np.linalg.solve(mass, tau - coriolis - gravity)])


def step(x, tau, h):
    """The state after h seconds by the classical Runge–Kutta method of order 4."""
    k1 = rate(x, tau)
    k2 = rate(x + 0.5 * h * k1, tau)
    k3 = rate(x + 0.5 * h * k2, tau)
    k4 = rate(x + h * k3, tau)
    return x + h / 6 * (k1 + 2 * (k2 + k3) + k4)


def tip(x):
    """Height of the tip above the first joint, m."""
    return -LENGTH[0] * np.cos(x[0]) - LENGTH[1] * np.cos(x[0] + x[1])


def main(robot="acrobot"):
    """Prints when the tip is above 90% of its greatest height for good, in 10 s from hanging."""
    anywhere = Anywhere(robot, progress=lambda so_far: print(f"\rstart {so_far.searched} of {so_far.starts}", end="", file=sys.stderr))
    seconds = anywhere.controller.seconds
    print(f"\n{len(seconds)} motions of {seconds.min():.2f} to {seconds.max():.2f} s")
    anywhere.init_()
    x, low, searches = np.zeros(4), 0.0, 0
    for k in range(round(10 / TICK)):
        tau = anywhere.get_control_output_(x, k * TICK)
        searches += anywhere.controller.searched
        x = step(x, tau, TICK)
        if tip(x) <= 0.9 * sum(LENGTH):
            low = (k + 1) * TICK
    off = np.abs(np.remainder(x[:2] - [np.pi, 0.0] + np.pi, 2 * np.pi) - np.pi).max()
    print(f"the tip of the {robot} stays up from {low + TICK:.3f} s on, {searches} search{'es' * (searches > 1)}; after 10 s it is {off:.4f} rad off")


if __name__ == "__main__":
    main(*sys.argv[1:])
