"""Problems of trajectory optimisation as `leastaction plan` reads them, and their robots, for `control_casadi.py`."""

import math
import tomllib
import xml.etree.ElementTree as ElementTree
from collections import deque
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from common import Failure


@dataclass
class Link:
    """A link with the joint that carries it; vectors and matrices are in the frame of the link, the pose in that of its parent."""

    parent: int  # index among the links, −1: the base
    kind: str  # revolute, prismatic or fixed
    rotation: np.ndarray
    place: np.ndarray
    axis: np.ndarray
    mass: float
    centre: np.ndarray
    inertia: np.ndarray  # about the centre


@dataclass
class Problem:
    """A problem with every default filled in; arrays have a number per coordinate, of `u` only the driven ones are free."""

    name: str
    links: list
    tick: float
    ticks_per_node: int
    nodes: int
    start: np.ndarray  # q, then v
    goal: np.ndarray  # [least, most] of q, then of v
    u: np.ndarray  # [least, most]
    limits: np.ndarray  # [least, most] of q, then of v
    weights: dict  # u, q, v: arrays; time: a number
    target: np.ndarray  # q, v that the weights refer to

    @property
    def coordinates(self):
        return len(self.u)

    @property
    def driven(self):
        return np.flatnonzero(self.u[:, 0] < self.u[:, 1])

    @property
    def node_seconds(self):
        return self.tick * self.ticks_per_node


# ---------------------------------------------------------------- robot descriptions


def numbers(element, attribute, usual):
    text = element.get(attribute) if element is not None else None
    return np.array([float(word) for word in text.split()] if text else usual)


def rotation_of(rpy):
    """Rz(yaw) Ry(pitch) Rx(roll), without the rounding errors of right angles."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return np.round(z @ y @ x, 15)


def pose(element):
    origin = element.find("origin") if element is not None else None
    return rotation_of(numbers(origin, "rpy", [0, 0, 0])), numbers(origin, "xyz", [0, 0, 0])


def inertial(link):
    """Mass, centre, and inertia about the centre in the frame of the link."""
    element = link.find("inertial")
    if element is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    rotation, centre = pose(element)
    of = {key: float(value) for key, value in element.find("inertia").attrib.items()}
    rows = [[of["ixx"], of["ixy"], of["ixz"]], [of["ixy"], of["iyy"], of["iyz"]], [of["ixz"], of["iyz"], of["izz"]]]
    return float(element.find("mass").get("value")), centre, rotation @ np.array(rows) @ rotation.T


KINDS = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic", "fixed": "fixed"}


def read_joint(joint, link, parent, path):
    kind = KINDS.get(joint.get("type"))
    if kind is None:
        raise Failure(f"{path}: joint {joint.get('name')} is {joint.get('type')}; use one of {', '.join(KINDS)}", code=2)
    axis = numbers(joint.find("axis"), "xyz", [1, 0, 0])
    return Link(parent, kind, *pose(joint), axis / np.linalg.norm(axis), *inertial(link))


def read_robot(path):
    """Links but for the root, in the order of a breadth-first walk."""
    try:
        root = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise Failure(f"{path} is not a readable robot description: {error}", code=2) from error
    links = {link.get("name"): link for link in root.findall("link")}
    joints = root.findall("joint")
    children = {joint.find("child").get("link") for joint in joints}
    waiting, found = deque((name, -1) for name in links if name not in children), []
    while waiting:
        name, index = waiting.popleft()
        for joint in joints:
            if joint.find("parent").get("link") == name:
                child = joint.find("child").get("link")
                waiting.append((child, len(found)))
                found.append(read_joint(joint, links[child], index, path))
    return found


# ---------------------------------------------------------------- configurations


def intervals(values, count, around=False):
    """[least, most] per coordinate; a number is an interval of one value, or with `around` of both signs, and [] is everything."""
    rows = np.empty((count, 2))
    for row, value in zip(rows, values, strict=True):
        if isinstance(value, list):
            row[:] = value or [-math.inf, math.inf]
        else:
            row[:] = [-value, value] if around else [value, value]
    return rows


def number_of_nodes(config, path):
    seconds = config["seconds"]
    if isinstance(seconds, list):
        raise Failure(f"{path}: `seconds` is an interval, and this comparison has fixed times only: give one number", code=2)
    return round(seconds / (config["tick"] * config.get("ticks_per_node", 1)))


def both(table, count, around, usual):
    """Intervals of q, then of v."""
    q, v = table.get("q", usual["q"] * count), table.get("v", usual["v"] * count)
    return np.vstack([intervals(q, count, around), intervals(v, count, around)])


def problem_of(config, links, path):
    count = sum(link.kind != "fixed" for link in links)
    cost, limits = config["cost"], config.get("limits", {})
    if config.get("order", 2) != 2 or "energy" in config["goal"]:
        raise Failure(f"{path}: this comparison has steps of order 2 and goals of q and v only", code=2)
    zeros = [0.0] * count
    goal = both(config["goal"], count, False, {"q": [[]], "v": [0.0]})
    return Problem(
        name=path.stem,
        links=links,
        tick=config["tick"],
        ticks_per_node=config.get("ticks_per_node", 1),
        nodes=number_of_nodes(config, path),
        start=np.array([*config["start"]["q"], *config["start"].get("v", zeros)]),
        goal=goal,
        u=intervals(limits["u"], count, True),
        limits=both(limits, count, True, {"q": [[]], "v": [[]]}),
        weights={key: np.array(cost.get(key, zeros)) for key in "uqv"} | {"time": cost.get("time", 0.0)},
        target=np.nan_to_num(goal.mean(axis=1)),
    )


def read_problem(path):
    """Reads a configuration and the robot description that it names."""
    path = Path(path)
    try:
        config = tomllib.loads(path.read_text())
        return problem_of(config, read_robot(path.parent / config["model"]), path)
    except (OSError, tomllib.TOMLDecodeError, ValueError) as error:
        raise Failure(f"{path} cannot be read: {error}", code=2) from error
    except KeyError as error:
        raise Failure(f"{path}: {error} is missing", code=2) from error
