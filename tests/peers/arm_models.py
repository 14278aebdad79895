"""Trees of rigid bodies that the comparisons of arms share, as the input of their programs and as MJCF."""

import math
import random

HALF = math.pi / 2
GRAVITY = [0, 0, -9.81]
# Joint frames (α, a, θ, d), each relative to the one before: Rx(α) Tx(a) Rz(θ) Tz(d), Craig's convention, from the makers' documents.
PANDA = [(0, 0, 0, 0.333), (-HALF, 0, 0, 0), (HALF, 0, 0, 0.316), (HALF, 0.0825, 0, 0), (-HALF, -0.0825, 0, 0.384),
         (HALF, 0, 0, 0), (HALF, 0.088, 0, 0)]
IIWA = [(0, 0, 0, 0.36), (-HALF, 0, 0, 0), (HALF, 0, 0, 0.42), (HALF, 0, 0, 0), (-HALF, 0, 0, 0.4), (-HALF, 0, 0, 0),
        (HALF, 0, 0, 0.126)]
UR5 = [(0, 0, 0, 0.089159), (HALF, 0, 0, 0), (0, -0.425, 0, 0), (0, -0.39225, 0, 0.10915), (HALF, 0, 0, 0.09465),
       (-HALF, 0, 0, 0.0823)]
# Two arms on a trunk with sliding joints: (parent, whether the joint slides).
TREE = [(-1, 0), (0, 0), (1, 0), (2, 1), (3, 1), (3, 0), (1, 1), (6, 0), (7, 1), (8, 0), (-1, 0), (10, 1)]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turn(axis, angle):
    """The rotation about a unit axis."""
    x, y, z = axis
    c, s = math.cos(angle), math.sin(angle)
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def direction(dice):
    x = [dice.gauss(0, 1) for _ in range(3)]
    length = math.hypot(*x)
    return [entry / length for entry in x]


def inertia(dice):
    """The ten inertial numbers of a cloud of point masses, hence of a physical body."""
    points = [(dice.uniform(0.1, 1), [dice.uniform(-0.15, 0.15) for _ in range(3)]) for _ in range(6)]
    second = [[sum(m * x[i] * x[j] for m, x in points) for j in range(3)] for i in range(3)]
    trace = sum(second[i][i] for i in range(3))
    about = [[(trace if i == j else 0) - second[i][j] for j in range(3)] for i in range(3)]
    first = [sum(m * x[i] for m, x in points) for i in range(3)]
    return [sum(m for m, _ in points), *first, about[0][0], about[0][1], about[1][1], about[0][2], about[1][2], about[2][2]]


def body(dice, rotation, place, axis):
    return [*sum(rotation, []), *place, *axis, *inertia(dice), dice.uniform(0, 0.3)]


def of_frames(frames):
    """A chain of revolute joints."""
    def one(dice, frame):
        alpha, a, theta, d = frame
        tilt = turn([1, 0, 0], alpha)
        place = [a, -math.sin(alpha) * d, math.cos(alpha) * d]
        return body(dice, times(tilt, turn([0, 0, 1], theta)), place, [0, 0, 1])
    return [(k - 1, 0) for k in range(len(frames))], lambda dice: [one(dice, frame) for frame in frames]


def of_tree(tree):
    """A tree of joints with random axes and places."""
    def one(dice):
        place = [dice.gauss(0, 0.4) for _ in range(3)]
        return body(dice, turn(direction(dice), dice.uniform(-3, 3)), place, direction(dice))
    return tree, lambda dice: [one(dice) for _ in tree]


ARMS = {"panda": of_frames(PANDA), "iiwa": of_frames(IIWA), "ur5": of_frames(UR5), "tree of 12": of_tree(TREE)}


def text(name, states, seed):
    """The input of all programs, and the bodies in it."""
    dice = random.Random(f"{name} {seed}")
    tree, bodies = ARMS[name]
    bodies = bodies(dice)
    weights = [*GRAVITY, *sum(bodies, [])]
    numbers = [dice.gauss(0, 1) for _ in range(3 * len(tree) * states)]
    words = [len(tree), *sum(map(list, tree), []), *weights, states, *numbers]
    return " ".join(repr(word) for word in words), bodies


def mjcf(tree, bodies):
    """The arm as MJCF, MuJoCo's format: inertias about the centres of mass."""
    def words(numbers):
        return " ".join(map(repr, numbers))

    def one(k):
        (_, slides), numbers = tree[k], bodies[k]
        place, axis, (mass, *rest), rotor = numbers[9:12], numbers[12:15], numbers[15:25], numbers[25]
        centre, (xx, xy, yy, xz, yz, zz) = [first / mass for first in rest[:3]], rest[3:]
        x, y, z = centre
        about = [xx - mass * (y * y + z * z), yy - mass * (x * x + z * z), zz - mass * (x * x + y * y),
                 xy + mass * x * y, xz + mass * x * z, yz + mass * y * z]
        children = "".join(one(child) for child, (parent, _) in enumerate(tree) if parent == k)
        return (f'<body pos="{words(place)}" xyaxes="{words([*numbers[0:9:3], *numbers[1:9:3]])}">'
                f'<joint type="{"slide" if slides else "hinge"}" axis="{words(axis)}" armature="{rotor!r}"/>'
                f'<inertial pos="{words(centre)}" mass="{mass!r}" fullinertia="{words(about)}"/>{children}</body>')

    roots = "".join(one(k) for k, (parent, _) in enumerate(tree) if parent == -1)
    off = " ".join(f'{what}="disable"' for what in ["constraint", "contact", "spring", "damper", "actuation", "sensor"])
    return (f'<mujoco><compiler angle="radian"/><option gravity="{words(GRAVITY)}"><flag {off}/></option>'
            f"<worldbody>{roots}</worldbody></mujoco>")
