#!/usr/bin/env python3
"""Draws the explanatory pictures (src/images): python3 docs/book/pictures.py. All curves are computed, none is drawn by eye."""

import math
from pathlib import Path

IMAGES = Path(__file__).resolve().parent / "src" / "images"
INK, GREY, BLUE, RED, GREEN = "#1b1b1b", "#767676", "#1f6fb4", "#c0392b", "#2e8540"


class Picture:
    """An SVG picture in units of pixels."""

    def __init__(self, width, height, title):
        self.size, self.parts = (width, height), [f"<title>{title}</title>"]
        self.parts.append(f'<rect width="{width}" height="{height}" fill="white"/>')

    def text(self, x, y, words, size=15, anchor="middle", colour=INK, style="normal"):
        words = words.replace("&", "&amp;").replace("<", "&lt;")
        self.parts.append(f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size}" text-anchor="{anchor}" fill="{colour}" '
                          f'font-style="{style}">{words}</text>')

    def line(self, points, colour=INK, width=1.5, dash="", arrow=False):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        dash = f' stroke-dasharray="{dash}"' if dash else ""
        head = ' marker-end="url(#head)"' if arrow else ""
        self.parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}"{dash}{head}/>')

    def dot(self, x, y, radius=4, colour=INK, fill=None):
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" stroke="{colour}" fill="{fill or colour}"/>')

    def box(self, x, y, width, height, lines, colour=INK):
        self.parts.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="6" fill="white" stroke="{colour}" stroke-width="1.5"/>')
        for k, words in enumerate(lines):
            at = y + height / 2 + 5 + 20 * (k - (len(lines) - 1) / 2)
            self.text(x + width / 2, at, words, 15 if k == 0 else 13, colour=colour if k == 0 else GREY)

    def arrow(self, x0, y0, x1, y1, words="", above=True, colour=INK):
        self.line([(x0, y0), (x1, y1)], colour, arrow=True)
        if words:
            self.text((x0 + x1) / 2, (y0 + y1) / 2 + (-8 if above else 18), words, 13, colour=GREY)

    def save(self, name):
        width, height = self.size
        head = ('<defs><marker id="head" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" orient="auto">'
                f'<path d="M0,0 L10,5 L0,10 z" fill="{INK}"/></marker></defs>')
        text = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
                f'font-family="system-ui, sans-serif">\n{head}\n' + "\n".join(self.parts) + "\n</svg>\n")
        (IMAGES / name).write_text(text)


class Axes:
    """Axes in a picture, which map numbers to pixels."""

    def __init__(self, picture, left, top, width, height, x, y):
        self.picture, self.x, self.y = picture, x, y
        self.place = (left, top, width, height)
        picture.line([(left, top), (left, top + height), (left + width, top + height)], GREY, 1)

    def at(self, x, y):
        left, top, width, height = self.place
        return (left + width * (x - self.x[0]) / (self.x[1] - self.x[0]),
                top + height * (1 - (y - self.y[0]) / (self.y[1] - self.y[0])))

    def curve(self, points, colour=INK, width=2, dash=""):
        self.picture.line([self.at(x, y) for x, y in points], colour, width, dash)

    def labels(self, x_label, y_label, x_ticks=(), y_ticks=()):
        left, top, width, height = self.place
        self.picture.text(left + width / 2, top + height + 38, x_label, 13, colour=GREY)
        self.picture.text(left, top - 10, y_label, 13, colour=GREY)
        for value, words in x_ticks:
            x, _ = self.at(value, self.y[0])
            self.picture.line([(x, top + height), (x, top + height + 4)], GREY, 1)
            self.picture.text(x, top + height + 18, words, 12, colour=GREY)
        for value, words in y_ticks:
            _, y = self.at(self.x[0], value)
            self.picture.line([(left - 4, y), (left, y)], GREY, 1)
            self.picture.text(left - 7, y + 4, words, 12, "end", GREY)


def way():
    p = Picture(860, 190, "From a log to a controller")
    p.box(10, 60, 150, 70, ["log of q and u", ".csv, .npz, .mcap"], BLUE)
    p.box(240, 60, 170, 70, ["leastaction train", "T and V, friction, drive"])
    p.box(490, 60, 130, 70, ["m.postcard", "0.3 to 5 KB"], BLUE)
    p.box(700, 60, 150, 70, ["microcontroller", "no heap, no panic"])
    p.arrow(160, 95, 238, 95)
    p.arrow(410, 95, 488, 95, "export")
    p.arrow(620, 95, 698, 95, "flash")
    p.text(325, 152, "on your desk, in double precision", 13, colour=GREY)
    p.text(775, 152, "q(t + h), forces, energy", 13, colour=GREY)
    p.text(775, 171, "in single precision", 13, colour=GREY)
    p.text(430, 32, "the same bits in simulation on the desk and on the chip", 14, style="italic")
    p.line([(325, 58), (325, 42), (775, 42), (775, 58)], GREY, 1, "4 4")
    p.save("way.svg")


def loop():
    p = Picture(860, 250, "The control loop")
    p.box(330, 10, 180, 60, ["machine", "M v̇ = … + u"], BLUE)
    p.box(600, 95, 170, 60, ["encoders", "grid, noise, zeros"], BLUE)
    p.box(90, 95, 170, 60, ["drive", "gain, offset, delay"], BLUE)
    p.box(470, 180, 180, 60, ["observer", "steps the model"])
    p.box(210, 180, 180, 60, ["controller", "inverse dynamics, energy"])
    p.line([(510, 40), (685, 40), (685, 93)], arrow=True)
    p.text(600, 32, "q", 14)
    p.line([(685, 155), (685, 210), (652, 210)], arrow=True)
    p.text(708, 200, "reading", 13, "start", GREY)
    p.arrow(470, 210, 392, 210, "q̂, v̂")
    p.line([(210, 210), (175, 210), (175, 157)], arrow=True)
    p.text(160, 200, "command", 13, "end", GREY)
    p.line([(175, 95), (175, 40), (328, 40)], arrow=True)
    p.text(250, 32, "force u", 13, colour=GREY)
    p.line([(300, 180), (300, 165), (560, 165), (560, 178)], GREY, 1.2, "4 4", arrow=True)
    p.text(430, 158, "the same command, as late as the drive", 13, colour=GREY)
    p.save("loop.svg")


def energies():
    """Draws V of a pendulum of 1 kg and 1 m, and the force as minus its slope."""
    p = Picture(760, 300, "The potential of a pendulum, and the force as minus its slope")
    turns = [(-math.pi, "−π"), (0, "0"), (math.pi, "π")]
    grid = [math.pi * k / 60 for k in range(-60, 61)]
    left = Axes(p, 60, 40, 280, 200, (-math.pi, math.pi), (-12, 12))
    left.curve([(q, -9.81 * math.cos(q)) for q in grid], BLUE)
    left.labels("angle q, rad (0 hangs)", "V(q), J", turns, [(-9.81, "−9.8"), (0, "0"), (9.81, "9.8")])
    q0 = 0.9
    slope = 9.81 * math.sin(q0)
    left.curve([(q0 + d, -9.81 * math.cos(q0) + slope * d) for d in (-0.9, 0.9)], RED, 1.5)
    p.dot(*left.at(q0, -9.81 * math.cos(q0)), colour=RED)
    p.text(*[a + b for a, b in zip(left.at(q0, -9.81 * math.cos(q0)), (16, 22))], "slope V_q", 13, "start", RED)
    right = Axes(p, 440, 40, 280, 200, (-math.pi, math.pi), (-12, 12))
    right.curve([(q, -9.81 * math.sin(q)) for q in grid], INK)
    right.labels("angle q, rad", "torque −V_q, N m", turns, [(-9.81, "−9.8"), (0, "0"), (9.81, "9.8")])
    p.dot(*right.at(q0, -slope), colour=RED)
    p.save("energies.svg")


def network():
    p = Picture(780, 260, "One network gives potential and inertia matrix")
    inputs, hidden, outputs = [(120, 80), (120, 130), (120, 180)], [(300, 50 + 40 * k) for k in range(5)], [(480, 60 + 50 * k) for k in range(4)]
    for a, b in ((inputs, hidden), (hidden, outputs)):
        for x0, y0 in a:
            for x1, y1 in b:
                p.line([(x0, y0), (x1, y1)], "#c9c9c9", 0.8)
    for (x, y), words in zip(inputs, ["x", "cos θ", "sin θ"]):
        p.dot(x, y, 7, BLUE, "white")
        p.text(x - 16, y + 5, words, 14, "end", BLUE)
    for x, y in hidden:
        p.dot(x, y, 7, INK, "white")
    for (x, y), words in zip(outputs, ["V", "L₁₁", "L₂₁", "L₂₂"]):
        p.dot(x, y, 7, RED if words == "V" else GREEN, "white")
        p.text(x + 16, y + 5, words, 14, "start", RED if words == "V" else GREEN)
    p.text(300, 245, "hidden units, smooth: tanh, softplus, …", 13, colour=GREY)
    p.text(560, 65, "potential energy", 14, "start", RED)
    p.text(560, 150, "H = L Lᵀ + εI", 15, "start", GREEN)
    p.text(560, 172, "T = ½ vᵀ H v > 0", 15, "start", GREEN)
    p.text(560, 205, "whatever the weights are", 13, "start", GREY)
    p.save("network.svg")


def step():
    """Draws the paths of a step of order 2 and 4 beside the exact motion: a pendulum released from rest; all share the end points."""
    p = Picture(780, 320, "The path over one step, at order 2 and 4")
    h = 0.8
    motion = swing(1.2, 0.0, h, 400)
    ends = motion[0], motion[200], motion[400]
    a = Axes(p, 70, 40, 420, 220, (-0.05, 1.05), (-1.2, 1.4))
    a.curve([(k / 400, q) for k, (q, _) in enumerate(motion)], BLUE, 2.5)
    q0, qm, q1 = (q for q, _ in ends)
    a.curve([(0, q0), (1, q1)], RED, 1.5)
    bubble = qm - (q0 + q1) / 2
    a.curve([(c / 50, q0 + (q1 - q0) * c / 50 + 4 * (c / 50) * (1 - c / 50) * bubble) for c in range(51)], GREEN, 1.5, "6 3")
    for c in (0, 1):
        p.dot(*a.at(c, (q0, q1)[c]))
    p.dot(*a.at(0.5, (q0 + q1) / 2), colour=RED, fill="white")
    for c in (0.5 - math.sqrt(3) / 6, 0.5 + math.sqrt(3) / 6):
        p.dot(*a.at(c, q0 + (q1 - q0) * c + 4 * c * (1 - c) * bubble), colour=GREEN, fill="white")
    a.labels("time, of a step", "position", [(0, "t"), (0.5, "t + h/2"), (1, "t + h")])
    p.text(*[u + v for u, v in zip(a.at(0, q0), (-10, -8))], "q₀", 14, "end")
    p.text(*[u + v for u, v in zip(a.at(1, q1), (10, 8))], "q₁", 14, "start")
    for k, (words, colour) in enumerate([("the motion: a pendulum of 1 m;", BLUE), ("h = 0.8 s, to see a difference", BLUE),
                                         ("order 2: a straight line,", RED), ("L at its middle (○)", RED),
                                         ("order 4: a parabola,", GREEN), ("L at two Gauss points (○)", GREEN)]):
        p.text(520, 80 + 26 * k + 12 * (k // 2), words, 14, "start", colour)
    p.save("step.svg")


def swing(q, v, duration, steps):
    """Motion of a pendulum of 1 m, by the classical Runge–Kutta method."""
    h, out = duration / steps, [(q, v)]
    f = lambda q, v: (v, -9.81 * math.sin(q))
    for _ in range(steps):
        q, v = runge_kutta(f, q, v, h)
        out.append((q, v))
    return out


def runge_kutta(f, q, v, h):
    a = f(q, v)
    b = f(q + h / 2 * a[0], v + h / 2 * a[1])
    c = f(q + h / 2 * b[0], v + h / 2 * b[1])
    d = f(q + h * c[0], v + h * c[1])
    return q + h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0]), v + h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])


def midpoint_step(q, p, h):
    """One DEL step of order 2 for L = ½v² + 9.81 cos q: p + h/2 F((q + q₁)/2) = (q₁ − q)/h, solved by Newton's method."""
    w = p
    for _ in range(50):
        middle = q + h / 2 * w
        residual = p - h / 2 * 9.81 * math.sin(middle) - w
        w -= residual / (-1 - h * h / 4 * 9.81 * math.cos(middle))
    return q + h * w, p - h * 9.81 * math.sin(q + h / 2 * w)


def drift():
    """Draws the energy of a pendulum over 400 s at h = 0.1 s: DEL of order 2, Runge–Kutta of order 4, explicit midpoint of order 2."""
    p = Picture(780, 330, "Energy over time by three integrators")
    h, steps = 0.1, 4000
    start = 1.5
    energy = lambda q, v: v * v / 2 - 9.81 * math.cos(q)
    reference = energy(start, 0.0)
    f = lambda q, v: (v, -9.81 * math.sin(q))

    def explicit(q, v, h):
        a = f(q, v)
        b = f(q + h / 2 * a[0], v + h / 2 * a[1])
        return q + h * b[0], v + h * b[1]

    runs = [("explicit midpoint, order 2", GREY, explicit), ("Runge–Kutta, order 4", RED, lambda q, v, h: runge_kutta(f, q, v, h)),
            ("DEL, order 2", BLUE, midpoint_step)]
    a = Axes(p, 80, 40, 440, 230, (0, h * steps), (-0.4, 0.4))
    for k, (words, colour, one) in enumerate(runs):
        q, v, points = start, 0.0, [(0.0, 0.0)]
        for i in range(1, steps + 1):
            q, v = one(q, v, h)
            error = energy(q, v) - reference
            if error > 0.4:
                break
            if i % 4 == 0:
                points.append((h * i, error))
        a.curve(points, colour, 1.2)
        p.text(545, 90 + 34 * k, words, 14, "start", colour)
    a.labels("time, s", "energy − its start, J", [(t, str(t)) for t in (0, 100, 200, 300, 400)], [(e, f"{e}".replace("-", "−")) for e in (-0.4, -0.2, 0, 0.2, 0.4)])
    p.text(545, 200, "A pendulum of 1 kg and 1 m,", 13, "start", GREY)
    p.text(545, 219, "released at 1.5 rad, h = 0.1 s.", 13, "start", GREY)
    p.save("drift.svg")


def windows():
    """Draws a noisy log and predictions over windows, each from its own start state."""
    p = Picture(780, 320, "Windows of a noisy log")
    motion = swing(1.0, 0.0, 3.0, 3000)
    a = Axes(p, 60, 40, 660, 220, (0, 3), (-1.5, 1.5))
    state = 7
    for k in range(0, 61):
        noise = 0.0
        for _ in range(12):  # a sum of twelve uniform numbers is nearly normal
            state = (1103515245 * state + 12345) % 2**31
            noise += state / 2**31
        p.dot(*a.at(k * 0.05, motion[50 * k][0] + 0.09 * (noise - 6)), 2.6, GREY)
    for k, colour in enumerate([BLUE, RED, GREEN]):
        begin = motion[1000 * k]
        q, v = begin[0], begin[1]
        a.curve([(k + t, q) for t, (q, _) in zip((i / 1000 for i in range(1001)), swing(q, v, 1.0, 1000))], colour, 2)
        p.dot(*a.at(k, q), 6, colour, "white")
        p.text(*[u + w for u, w in zip(a.at(k + 0.5, 1.5), (0, -2))], f"window {k + 1}", 13, colour=colour)
        if k:
            a.curve([(k, -1.5), (k, 1.4)], "#c9c9c9", 1, "4 4")
    a.labels("time, s", "q, rad", [(t, str(t)) for t in range(4)], [(-1, "−1"), (0, "0"), (1, "1")])
    p.text(390, 312, "○ start states, found beside the weights; ● samples", 13, colour=GREY)
    p.save("windows.svg")


def tree():
    p = Picture(780, 280, "One type of element in two trees")
    for left, angles, words in ((60, [0.5, -0.3], "learned on two"), (420, [0.5, -0.3, 0.7, 0.1], "runs in four")):
        x, y = left + 60, 40
        p.line([(x - 40, y), (x + 40, y)], INK, 3)
        for k, angle in enumerate(angles):
            to = (x + 58 * math.sin(angle), y + 58 * math.cos(angle) * (0.85 if len(angles) > 2 else 1))
            p.line([(x, y), to], INK, 2)
            p.dot(*to, 9, BLUE)
            p.text(to[0] + 18, to[1] + 5, f"x{'₁₂₃₄'[k]}", 14, "start")
            x, y = to
        p.text(left + 200, 60, words, 15, "start", GREY)
    p.text(390, 268, "x_e = x_parent + s(q_e): the same s, mass and potential in every blue element", 14, colour=BLUE)
    p.save("tree.svg")


def friction():
    p = Picture(760, 300, "Dry and viscous friction over velocity")
    a = Axes(p, 80, 40, 380, 200, (-1, 1), (-1.6, 1.6))
    grid = [k / 200 for k in range(-200, 201)]
    a.curve([(-1, 0), (1, 0)], "#c9c9c9", 1)
    for width, colour in ((0.02, INK), (0.1, BLUE), (0.3, GREEN)):
        a.curve([(v, -(0.4 * v + math.tanh(v / width))) for v in grid], colour)
    a.labels("velocity v, rad/s", "Q, N m", [(-1, "−1"), (0, "0"), (1, "1")], [(-1, "−1"), (0, "0"), (1, "1")])
    for k, (words, colour) in enumerate([("Q = −b v − c tanh(v/ε)", INK), ("b = 0.4 N m s, c = 1 N m", GREY), ("ε = 0.02 rad/s", INK),
                                         ("ε = 0.1 rad/s", BLUE), ("ε = 0.3 rad/s", GREEN)]):
        p.text(500, 90 + 28 * k, words, 14, "start", colour)
    p.save("friction.svg")


for draw in (way, loop, energies, network, step, drift, windows, tree, friction):
    draw()
