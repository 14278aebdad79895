"""Linear approximations against differences, and linear regulators in closed loop."""

import numpy as np
import pytest
from conftest import MODELS

import leastaction as la

STATE = (np.array([0.1, 0.4]), np.array([0.3, -0.2]), np.array([0.5, -0.1]))


def differences(of, x, step):
    """Derivatives of a function of x, [outputs, len(x)], by central differences."""
    moves = step * np.eye(len(x))
    return np.stack([(of(x + move) - of(x - move)) / (2 * step) for move in moves], -1)


def test_derivatives_are_differences(cartpole):
    q, v, u = STATE
    found, model = cartpole.linearize(q, v, u), cartpole.double
    assert np.allclose(found.acceleration, model.acceleration(q, v, u))
    expected = differences(lambda x: model.acceleration(x[:2], x[2:4], x[4:]), np.concatenate(STATE), 1e-5)
    assert np.allclose(np.hstack([found.acceleration_q, found.acceleration_v, found.acceleration_u]), expected, atol=1e-6)
    motion = np.concatenate([q, v, found.acceleration])
    expected = differences(lambda x: model.inverse_dynamics(x[:2], x[2:4], x[4:]), motion, 1e-5)
    assert np.allclose(np.hstack([found.control_q, found.control_v, found.control_a]), expected, atol=1e-6)
    assert found.A.shape == (4, 4) and np.array_equal(found.A[:2, 2:], np.eye(2))
    assert np.array_equal(found.B[2:], found.acceleration_u) and not found.B[:2].any()


@pytest.mark.parametrize(("order", "ticks"), [(2, 1), (4, 1), (2, 3)])
def test_a_linear_step_is_a_difference_of_steps(cartpole, order, ticks):
    found = cartpole.linearize_step(*STATE, h=0.02, order=order, ticks=ticks)

    def end(x):
        u = np.tile(x[4:], (ticks, 1))
        _, q, p = cartpole.double.rollout(x[:2], x[2:4], u, h=0.02, order=order)
        return np.concatenate([q[-1], p[-1]])

    expected = differences(end, np.concatenate(STATE), 1e-4)
    assert np.allclose(np.hstack([found.A, found.B]), expected, atol=2e-4)
    assert found.A.shape == (4, 4) and found.B.shape == (4, 2)


def test_a_known_regulator():
    """A double integrator under a held force: its Riccati equation holds, and scipy solves it alike."""
    A, B, Q, R = [[1, 0.1], [0, 1]], [[0.005], [0.1]], np.diag([1.0, 0.1]), [[0.01]]
    K, P, E = la.lqr(A, B, Q, R)
    linalg = pytest.importorskip("scipy.linalg")
    assert np.allclose(P, linalg.solve_discrete_are(A, B, Q, R), rtol=1e-9)
    assert K.shape == (1, 2) and np.allclose(np.sort(E), np.sort(np.linalg.eigvals(np.array(A) - B @ K)))
    assert np.abs(E).max() < 1
    assert np.allclose(la.lqr(A, B, [1.0, 0.1], [0.01]).K, K, rtol=1e-12)


def test_past_commands_are_states():
    A, B = np.array([[1, 0.1], [0, 1]]), np.array([[0.005], [0.1]])
    K, P, E = la.lqr(A, B, [1, 0.1], [0.01], delay=1.3)
    assert K.shape == (1, 4) and P.shape == (4, 4) and np.abs(E).max() < 1
    # Exact flows of 0.3 and 0.7 of a step; commands are sent, and arrive 1.3 steps later.
    flow = lambda s: (np.array([[1, 0.1 * s], [0, 1]]), np.array([0.005 * s * s, 0.1 * s]))  # noqa: E731
    start = np.array([1.0, -0.5, 0.3, 0.2])
    x, sent, cost = start[:2], [*start[3:1:-1]], 0.0
    for _ in range(400):
        u = -(K @ np.concatenate([x, sent[:-3:-1]]))[0]
        cost += x @ np.diag([1, 0.1]) @ x + 0.01 * u * u
        for part, command in ((0.3, sent[-2]), (0.7, sent[-1])):
            a, b = flow(part)
            x = a @ x + b * command
        sent.append(u)
    assert cost == pytest.approx(start @ P @ start, rel=1e-8) and np.abs(x).max() < 1e-6


@pytest.mark.parametrize("delay", [0.0, 0.013, 0.03])
def test_a_model_is_held_at_rest_by_late_drives(delay):
    """The double pendulum, upright, falls by itself; its regulator knows the delay. The motion is that of the chip."""
    model = la.load(MODELS / "double.postcard")
    h, up = 0.01, max(([np.pi, np.pi], [0, 0]), key=lambda q: model.energies(q, [0, 0])[1])
    regulator = model.lqr(up, [100, 100, 1, 1], [0.1, 0.1], h=h, delay=delay)
    past = int(np.ceil(delay / h - 1e-9))
    assert regulator.past == past and regulator.K.shape == (2, 4 + 2 * past) and np.abs(regulator.E).max() < 1
    left = {name: swung(model, regulator, up, h, delay, hold) for name, hold in (("held", True), ("free", False))}
    assert left["held"] < 1e-3 and left["free"] > 0.1, left


def test_a_lag_is_a_state():
    """A mass behind a lag and a delay of 1.3 steps: the promised cost is that of the motion, and the commands sent give y."""
    A, B, lag = [[1, 0.1], [0, 1]], [[0.005], [0.1]], 0.7
    K, P, _ = la.lqr(A, B, [1, 0.1], [0.01], delay=1.3, lag=lag)
    assert K.shape == (1, 5)
    regulator = la.RestRegulator(K, P, np.empty(0), np.zeros(1), np.zeros(1), (0,), 0.1, 0.13, (False,), 0.1 * lag)
    assert regulator.past == 2
    pieces, x, y, sent, cost, first = 4000, np.array([1.0, -0.5]), 0.0, [], 0.0, None
    for _ in range(300):
        past = np.array([*sent[::-1], 0.0, 0.0])[:, None]
        state = np.concatenate([x, [y], past[:2, 0]])
        u = regulator.command(x[:1], x[1:], past)[0]
        assert u == pytest.approx(-(K @ state)[0], abs=1e-6)
        cost, first = cost + x @ np.diag([1, 0.1]) @ x + 0.01 * u * u, state if first is None else first
        for k in range(0, pieces, 40):
            # y is exact over a piece, and so is the impulse on the mass.
            r, dt = past[1 if k < 0.3 * pieces else 0, 0], 40 / pieces
            end = r + (y - r) * np.exp(-dt / lag)
            impulse = r * dt - lag * (end - y)
            x = np.array([x[0] + 0.1 * (dt * x[1] + 0.1 * 0.5 * dt * impulse), x[1] + 0.1 * impulse])
            y = end
        sent.append(u)
    assert cost == pytest.approx(first @ P @ first, rel=1e-4) and np.abs(x).max() < 1e-6


def swung(model, regulator, up, h, delay, hold):
    """Deviation from rest after 4 s, the commands acting late by a delay, in steps of a tenth of the tick."""
    motion = model.motion(np.add(up, [0.05, -0.03]), np.zeros(2), h=h / 10)
    sent = [regulator.u] * 50
    for _ in range(400):
        past = np.array(sent[: -regulator.past - 1 : -1]) if regulator.past else None
        sent.append(regulator.command(motion.q, motion.v, past) if hold else regulator.u)
        for k in range(10):
            late = int(np.ceil((delay - k * h / 10) / h - 1e-9))
            motion.step(sent[-1 - max(late, 0)])
    return np.abs(motion.q - up).max()


def test_what_has_no_regulator_is_said(cartpole):
    A, B = np.diag([1.2, 0.5]), [[0], [1]]
    with pytest.raises(la.SolveError, match="stabilises"):
        la.lqr(A, B, [1, 1], [1])
    with pytest.raises(la.SolveError, match="does not see"):
        la.lqr(A, [[1], [1]], [0, 1], [1])
    with pytest.raises(la.InputError, match="Q is a matrix of 3 × 3"):
        la.lqr(A, B, np.eye(3), [1])
    with pytest.raises(la.InputError, match="B is a matrix of 1 × 1"):
        la.lqr(A, [[1]], [1, 1], [1])
    with pytest.raises(la.InputError, match="R must be symmetric and positive definite"):
        la.lqr(A, B, [1, 1], [0])
    with pytest.raises(la.InputError, match="not finite"):
        la.lqr(A, [[np.nan], [1]], [1, 1], [1])
    with pytest.raises(la.InputError, match="whole steps"):
        la.lqr([[-0.5]], [[1]], [1], [1], delay=0.5)
    with pytest.raises(la.InputError, match="delay of -1 steps"):
        la.lqr(A, B, [1, 1], [1], delay=-1)
    with pytest.raises(la.InputError, match="single state"):
        cartpole.linearize(np.zeros((3, 2)), np.zeros(2))
    with pytest.raises(la.InputError, match="not a rest"):
        cartpole.lqr([0, 1.0], np.ones(4), [1], driven=[0])
    with pytest.raises(la.InputError, match="driven"):
        cartpole.lqr([0, 0], np.ones(4), [1], driven=[2])
    with pytest.raises(la.InputError, match="`h` is -1"):
        cartpole.linearize_step(*STATE, h=-1)
    graph = la.load(MODELS / "pendulums.postcard")
    with pytest.raises(la.SolveError, match="rods"):
        graph.linearize(np.zeros(graph.n), np.zeros(graph.n))
