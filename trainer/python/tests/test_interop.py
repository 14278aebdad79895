"""Interfaces to other programs: SciPy, gymnasium, PyTorch and JAX."""

import numpy as np
import pytest

import leastaction as la


def test_scipy(cartpole):
    integrate = pytest.importorskip("scipy.integrate")
    y0 = np.array([0.1, 0.4, 0.0, -0.3])
    found = integrate.solve_ivp(cartpole.scipy_rhs(), (0, 0.5), y0, rtol=1e-11, atol=1e-12)
    steps = cartpole.double.rollout(y0[:2], y0[2:], steps=1000, h=0.0005)
    assert np.allclose(found.y[:2, -1], steps.q[-1], atol=1e-9)
    assert np.allclose(found.y[2:, -1], steps.v[-1], atol=1e-8)
    rhs = cartpole.scipy_rhs(lambda t, q, v: [t, 0.0])
    assert np.allclose(rhs(2.0, y0)[2:], cartpole.double.acceleration(y0[:2], y0[2:], [2.0, 0.0]))
    many = rhs(2.0, np.stack([y0, 2 * y0], 1))
    assert many.shape == (4, 2) and np.allclose(many[:, 0], rhs(2.0, y0))


def test_environment(cartpole):
    environment = la.Environment(
        cartpole,
        actuated=[0],
        max_u=3.0,
        start=lambda random: ([0.0, random.uniform(-0.1, 0.1)], [0.0, 0.0]),
        reward=lambda q, v, u: float(np.cos(q[1])),
        done=lambda q, v: abs(q[0]) > 2,
        max_steps=20,
    )
    first, info = environment.reset(seed=7)
    assert first.shape == environment.observation_space.shape == (4,) and info == {}
    again, _ = environment.reset(seed=7)
    assert np.array_equal(first, again)
    motion = cartpole.motion(first[:2], first[2:])
    for k in range(20):
        action = environment.action_space.sample()
        observed, reward, terminated, truncated, info = environment.step(action)
        motion.step([action[0], 0.0])
        assert np.array_equal(observed, np.concatenate([motion.q, motion.v]))
        assert reward == pytest.approx(np.cos(observed[1])) and not terminated
        assert truncated == (k == 19) and info["newton_iterations"] >= 1
    strong, _ = environment.reset(options={"q": [1.9, 0.0], "v": [9.0, 0.0]})
    assert strong[0] == np.float32(1.9)
    assert environment.step([100.0])[2]
    with pytest.raises(la.InputError, match="coordinates 0 to 1"):
        la.Environment(cartpole, actuated=[2])


def symo_network(random, n=2, width=5):
    """A function that draws random tensors of the shape of a layer."""
    layer = lambda outputs, inputs: random.normal(size=(outputs, inputs)).astype(np.float32) * 0.4  # noqa: E731
    return layer


def test_dictionaries_of_tensors_are_imported_as_safetensors(tmp_path):
    """The importer's message on an unknown name quotes the name in the dictionary."""
    with pytest.raises(la.InputError, match="trunk"):
        la.from_symo({"trunk": np.zeros((2, 3), np.float32)}, system="cartpole")
    with pytest.raises(la.InputError, match="numbers of type complex"):
        la.from_lgnn({"x": np.zeros(2, complex)})
    with pytest.raises(la.InputError, match="must be"):
        la.from_modlanet({}, system="star")
    with pytest.raises(la.InputError, match="missing"):
        la.from_symo(tmp_path / "missing.safetensors", system="cartpole")


def test_observer_finds_velocities_and_survives_gaps(cartpole):
    u = np.array([0.3, 0.0])
    truth = cartpole.rollout([0.0, 0.2], [0.1, -0.2], np.repeat(u[None], 40, 0))
    observer = cartpole.observer(memory=8)
    assert observer.estimate is None and not observer.trusted
    for k, q in enumerate(truth.q[:-1]):
        y = np.where(k % 5 == 4, [q[0], np.nan], q)
        estimate = observer.update(y, u)
    assert observer.trusted
    assert np.allclose(estimate.q, truth.q[-2], atol=1e-3) and np.allclose(estimate.v, truth.v[-2], atol=3e-2)
    with pytest.raises(la.InputError, match="graph"):
        from conftest import MODELS

        la.load(MODELS / "pendulums.postcard").observer(h=0.01)
