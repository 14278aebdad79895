"""Environments of gymnasium."""

import warnings
import xml.etree.ElementTree

import numpy as np
import pytest
from conftest import MODELS

import leastaction as la

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed")

from leastaction.gymnasium import Env  # noqa: E402


@pytest.mark.parametrize("name", ["cartpole", "double", "acrobot", "cartpole-dry"])
def test_gymnasium_accepts_it(name):
    from gymnasium.utils.env_checker import check_env

    model = la.load(MODELS / f"{name}.postcard")
    env = Env(model, limits=2.0, h=0.01, render_mode="svg")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*Box observation space (minimum|maximum) value is.*infinity.*")
        warnings.filterwarnings("ignore", message=".*we recommend using a symmetric and normalized space.*")
        warnings.filterwarnings("ignore", message=".*alternative render modes.*")
        check_env(env)


def test_episodes_are_seeded_and_step_as_the_model_does(cartpole):
    env = Env(cartpole, driven=[0], limits=[3.0], goal=[0.0, 3.0], max_steps=20)
    first, info = env.reset(seed=7)
    assert np.abs(first).max() <= 0.05 and np.ptp(first) > 0 and info["inside"] is True
    assert np.array_equal(first, env.reset(seed=7)[0]) and not np.array_equal(first, env.reset(seed=8)[0])
    observed, _ = env.reset(options={"q": [0.0, 0.2], "v": [0.1, 0.0]})
    motion = cartpole.motion(observed[:2], observed[2:])
    env.action_space.seed(1)
    for k in range(20):
        action = env.action_space.sample()
        observed, reward, terminated, truncated, info = env.step(action)
        motion.step([action[0], 0.0])
        assert np.array_equal(observed, np.concatenate([motion.q, motion.v]))
        away = np.hypot(motion.q[0], np.remainder(motion.q[1] - 3.0 + np.pi, 2 * np.pi) - np.pi)
        assert reward == pytest.approx(-away, rel=1e-6) and info["distance"] == pytest.approx(away, rel=1e-6)
        assert not terminated and truncated == (k == 19)
    ends = []
    for action in (50.0, 3.0):
        env.reset(seed=7)
        ends.append(env.step([action])[0])
    assert np.array_equal(*ends)


def test_functions_of_the_task(cartpole):
    env = Env(
        cartpole,
        limits=1.0,
        start=([0.0, 1.0], [0.0, 0.0]),
        reward=lambda q, v, u: float(u @ u),
        terminated=lambda q, v: bool(abs(q[1]) > 0.5),
    )
    assert np.array_equal(env.reset(seed=1)[0], np.float32([0, 1, 0, 0]))
    _, reward, terminated, truncated, _ = env.step([5.0, -5.0])
    assert reward == 2.0 and terminated and not truncated


def test_a_step_that_cannot_be_solved_truncates(cartpole):
    env = Env(cartpole, limits=1.0)
    before, _ = env.reset(options={"v": [0.0, 1e6], "q": [0.0, 0.0]})
    observed, _, terminated, truncated, info = env.step([0.0, 0.0])
    assert truncated and not terminated and "error" in info and np.array_equal(observed, before)


def test_the_picture_shows_every_coordinate(cartpole):
    env = Env(cartpole, limits=1.0, render_mode="svg", goal=[0.5, np.pi / 2])
    env.reset(options={"q": [0.0, 0.0], "v": [0.0, 0.0]})
    lines = list(xml.etree.ElementTree.fromstring(env.render()))
    assert [line.get("stroke") for line in lines] == ["silver", "black"] * 2
    places = [(float(line.get("x2")), float(line.get("y2"))) for line in lines]
    assert places == [(84.0, 72.0), (60.0, 72.0), (228.0, 60.0), (180.0, 108.0)]
    assert Env(cartpole, limits=1.0).render() is None


def test_what_cannot_be_is_said(cartpole):
    with pytest.raises(la.InputError, match="give limits"):
        Env(cartpole)
    with pytest.raises(la.InputError, match="goal="):
        Env(cartpole, limits=1.0, goal=[0.0])
    with pytest.raises(la.InputError, match="coordinates 0 to 1"):
        Env(cartpole, limits=1.0, driven=[2])
    with pytest.raises(la.InputError, match="must be positive"):
        Env(cartpole, limits=[-1.0, 1.0])
    with pytest.raises(la.InputError, match="one for each of 1"):
        Env(cartpole, limits=[1.0, 1.0], driven=[0])
    env = Env(cartpole, limits=1.0, driven=[0])
    with pytest.raises(la.InputError, match="begin an episode"):
        env.step([0.0])
    env.reset()
    for action in ([0.0, 0.0], 0.0, [np.nan]):
        with pytest.raises(la.InputError, match="a number for each of 1"):
            env.step(action)
    with pytest.raises(la.InputError, match="render_mode"):
        Env(cartpole, limits=1.0, render_mode="human")
