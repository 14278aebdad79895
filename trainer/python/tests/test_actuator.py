"""Commands become forces by gain, offset, delay and lag, in double precision as on the chip."""

import numpy as np
import pytest
import scipy.signal

import leastaction as la

H, GAIN, OFFSET = 0.05, -0.75, 0.25
STEPS = 30


NAMES = ["no delay", "part of a step", "steps and a part", "lag", "lag behind a delay"]


@pytest.fixture(scope="module", params=[(0.0, 0.0), (0.013, 0.0), (0.12, 0.0), (0.0, 0.03), (0.063, 0.008)], ids=NAMES)
def driven(request, log, tmp_path_factory):
    """A model whose file has an actuator, and the actuator's delay and lag, s."""
    delay, lag = request.param
    config = {"data": {"file": log}, "model": {"coordinates": "ta", "hidden": [8]}}
    config["calibration"] = {"gain": GAIN, "offset": OFFSET, "delay": delay, "lag": lag}
    config["training"] = {"iterations": 1, "loss": "windows", "threads": 2}
    return la.train(config, tmp_path_factory.mktemp("driven") / "run", progress=False).model, request.param


def naive_forces(commands, times, control):
    """The linear force over every step that has the impulse and the moment of g y + o, y being u(t − d) behind a lag, by a fine sum."""
    fine = (np.arange(20000) + 0.5) / 20000
    delay, lag = times
    late, count, y = delay / H, len(commands), commands[0]
    start, end = np.empty_like(commands), np.empty_like(commands)
    for k in range(count):
        at = np.clip(k + fine - late, 0, count - 1)
        below = np.floor(at).astype(int)
        along = 0 if control == "held" else (at - below)[:, None]
        u = commands[below] + along * (commands[np.minimum(below + 1, count - 1)] - commands[below])
        if lag > 0.0:
            # u is constant over a piece; y is taken in its middle.
            left = np.exp(-H / 20000 / lag)
            ends = scipy.signal.lfilter([1 - left], [1, -left], u, axis=0, zi=left * y[None])[0]
            u, y = 0.5 * (np.vstack([y, ends[:-1]]) + ends), ends[-1]
        force = GAIN * u + OFFSET
        mean, moment = force.mean(0), ((fine - 0.5)[:, None] * force).mean(0)
        start[k], end[k] = mean - 6 * moment, mean + 6 * moment
    return start, end


@pytest.mark.parametrize("control", ["held", "linear"])
def test_rollouts_know_the_actuator(driven, control):
    model, times = driven
    assert np.allclose(model.actuator["gain"], GAIN)
    assert [model.actuator["delay"], model.actuator["lag"]] == pytest.approx(times)
    t = H * np.arange(STEPS + (control == "linear"))[:, None]
    commands = 0.5 * np.sin(3 * t + [1, 2])
    start, end = naive_forces(commands, times, control)
    q, v = np.array([0.1, -0.2]), np.array([0.3, 0.1])
    for own, steps_within, forces_within in ((model.double, 1e-9, 1e-7), (model, 1e-4, 1e-5)):
        given = own.forces(commands, h=H, control=control)
        for ours, theirs in zip(given, (start, end)):
            assert np.abs(ours - theirs)[:STEPS].max() < forces_within
        found = own.rollout(q, v, commands, h=H, control=control, commands=True)
        now = q, v
        for k in range(STEPS):
            now = own.step(*now, given[0][k], u_end=given[1][k], h=H)
            assert np.allclose(now[0], found.q[k + 1], rtol=0, atol=steps_within)
            assert np.allclose(now[1], found.v[k + 1], rtol=0, atol=100 * steps_within)


def test_actions_on_an_environment_are_commands(driven):
    model, times = driven
    environment = la.Environment(model, max_u=1.0, start=([0.1, -0.2], [0.3, 0.1]), h=H, commands=True)
    before = int(np.ceil(times[0] / H)) + 1
    actions = 0.5 * np.sin(3 * H * np.arange(12)[:, None] + [1, 2])
    start, end = naive_forces(np.vstack([np.zeros((before, 2)), actions]), times, "held")
    for _ in range(2):
        now = environment.reset()[0]
        for k, action in enumerate(actions, before):
            now = np.concatenate(model.step(now[:2], now[2:], start[k], u_end=end[k], h=H))
            found = environment.step(action)[0]
            assert np.allclose(found, now, rtol=0, atol=1e-4)
            now = found
