"""Evaluation and steps of a model: bits, shapes, precision, threads."""

import pickle
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
from conftest import MODELS

import leastaction as la


def states(model, count, seed=0):
    """Random states; particles form a chain on their rods of length 1."""
    random = np.random.default_rng(seed)
    q, v, u = (0.4 * random.normal(size=(count, model.n)) for _ in range(3))
    if model.family == "graph":
        angles = random.uniform(-3, 3, (count, model.n // 2))
        q = np.cumsum(np.stack([np.sin(angles), -np.cos(angles)], -1), 1).reshape(count, -1)
    return q, v, u


def test_facts():
    model = la.load(MODELS / "cartpole.postcard")
    assert (model.family, model.n, model.order, model.h) == ("inertia-network", 2, 4, 0.05)
    assert model.parameters == len(model.weights) == 1284
    graph = la.load(MODELS / "pendulums.postcard", "three")
    assert graph.n == 6 and graph.part == "three" and graph.parts == ["two", "three"]
    assert set(graph.units) == {"m"}


def test_single_precision_agrees_with_double_within_rounding(model):
    q, v, u = states(model, 40)
    single, double = model.acceleration(q, v, u), model.double.acceleration(q, v, u)
    assert single.dtype == np.float32 and double.dtype == np.float64
    scale = np.abs(double).max()
    assert 0 < np.abs(single - double).max() < 2e-5 * scale
    for one, other in zip(model.energies(q, v), model.double.energies(q, v)):
        assert one.shape == (40,) and np.allclose(one, other, rtol=1e-4, atol=1e-4)
    mass = model.double.mass_matrix(q)
    assert np.allclose(model.mass_matrix(q), mass, rtol=1e-4, atol=1e-6)
    assert np.allclose(mass, np.swapaxes(mass, -1, -2))


def test_inverse_dynamics_inverts_acceleration(model):
    q, v, u = states(model, 20)
    if model.family == "graph":
        pytest.skip("rods carry a part of the force")
    for of, error in ((model, 1e-4), (model.double, 1e-11)):
        a = of.acceleration(q, v, u)
        assert np.allclose(of.inverse_dynamics(q, v, a), u, rtol=error, atol=error)


def test_kinetic_energy_is_that_of_the_mass_matrix(model):
    q, v, _ = states(model, 10)
    of = model.double
    kinetic, _ = of.energies(q, v)
    assert np.allclose(kinetic, 0.5 * np.einsum("bi,bij,bj->b", v, of.mass_matrix(q), v), rtol=1e-10)


def test_leading_axes_broadcast_and_change_no_bit(model):
    q, v, u = states(model, 300)
    together = model.acceleration(q, v, u)
    alone = np.stack([model.acceleration(*state) for state in zip(q, v, u)])
    assert np.array_equal(together, alone)
    shaped = model.acceleration(q.reshape(3, 100, -1), v.reshape(3, 100, -1), u.reshape(3, 100, -1))
    assert np.array_equal(shaped, together.reshape(3, 100, -1))
    crossed = model.acceleration(q[:3, None], v[0], u[None, :5])
    assert crossed.shape == (3, 5, model.n)
    assert np.array_equal(crossed[2, 4], model.acceleration(q[2], v[0], u[4]))
    assert model.acceleration(q[:0], v[:0], u[:0]).shape == (0, model.n)
    assert np.array_equal(model.acceleration(q, v), model.acceleration(q, v, 0 * q))
    strided = np.asfortranarray(q)
    assert np.array_equal(model.acceleration(strided, v[::-1][::-1], u), together)


def test_neither_threads_of_ours_nor_of_python_change_a_bit(cartpole, tmp_path):
    q, v, u = states(cartpole, 5000)
    expected = cartpole.acceleration(q, v, u)
    rolled = cartpole.rollout(q[:64], v[:64], steps=30)
    np.savez(tmp_path / "states.npz", q=q, v=v, u=u)
    program = (
        "import sys, numpy as np, leastaction as la\n"
        "s = np.load(sys.argv[1]); m = la.load(sys.argv[2])\n"
        "np.save(sys.argv[3], m.acceleration(s['q'], s['v'], s['u']))\n"
        "np.save(sys.argv[4], m.double.acceleration(s['q'], s['v'], s['u']))\n"
    )
    for threads in ("1", "3"):
        files = [tmp_path / f"{name}{threads}.npy" for name in ("single", "double")]
        words = [sys.executable, "-c", program, tmp_path / "states.npz", MODELS / "cartpole.postcard", *files]
        subprocess.run(list(map(str, words)), check=True, env={"RAYON_NUM_THREADS": threads, "PYTHONPATH": ":".join(sys.path)})
        assert np.array_equal(np.load(files[0]), expected)
        assert np.array_equal(np.load(files[1]), cartpole.double.acceleration(q, v, u))
    found = [None] * 4

    def work(k):
        found[k] = (cartpole.acceleration(q, v, u), cartpole.rollout(q[:64], v[:64], steps=30).q)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all(np.array_equal(a, expected) and np.array_equal(x, rolled.q) for a, x in found)


def test_rollouts_are_motions_step_by_step(model):
    q, v, u = states(model, 9)
    h = model.h or 0.01
    forces = np.repeat(u[:, None], 6, 1) * np.linspace(0, 1, 6)[:, None]
    if model.family == "graph":
        v = 0 * v
    t, q_all, v_all = model.rollout(q, v, forces, h=h)
    assert q_all.shape == (9, 7, model.n) and np.allclose(t, h * np.arange(7))
    motion = model.motion(q, v, h=h)
    for k in range(6):
        assert np.array_equal(motion.q, q_all[:, k]) and np.array_equal(motion.v, v_all[:, k])
        report = motion.step(forces[:, k])
        assert report.iterations.shape == (9,) and report.residual.max() < 1e-3
    assert np.array_equal(motion.q, q_all[:, 6]) and motion.t == pytest.approx(6 * h)
    assert np.array_equal(model.step(q, v, forces[:, 0], h=h)[0], q_all[:, 1])


def test_double_rollouts_agree_with_single_ones(model):
    if model.family == "graph":
        with pytest.raises(la.InputError, match="rods"):
            model.double.rollout(*states(model, 1)[:2], steps=1, h=0.01)
        return
    q, v, u = states(model, 20)
    single = model.rollout(q, v, u[:, None], h=model.h or 0.01)
    double = model.double.rollout(q, v, u[:, None], h=model.h or 0.01)
    assert np.allclose(single.q, double.q, atol=1e-4) and np.allclose(single.v, double.v, atol=1e-3)


def test_two_positions_begin_a_motion(cartpole):
    q, v, u = states(cartpole, 5)
    q_all = cartpole.rollout(q, v, np.repeat(u[:, None], 3, 1)).q
    next_one = cartpole.step_from_positions(q_all[:, 1], q_all[:, 2], np.repeat(u[:, None], 2, 1))
    assert np.allclose(next_one, q_all[:, 3], atol=2e-5)
    rolled = cartpole.rollout(q_all[:, 1], q1=q_all[:, 2], u=np.repeat(u[:, None], 2, 1))
    assert np.array_equal(rolled.q[:, 2], next_one) and np.isnan(rolled.v[:, 0]).all()
    motion = cartpole.motion_from_positions(q_all[:, 1], q_all[:, 2], u)
    motion.step(u)
    assert np.array_equal(motion.q, next_one)


def test_linear_controls(cartpole):
    q, v, u = states(cartpole, 4)
    samples = u[None] * np.ones((4, 1, 1))
    linear = cartpole.rollout(q, v, samples, control="linear")
    assert linear.q.shape == (4, 4, 2)
    held = cartpole.rollout(q, v, samples)
    assert held.q.shape == (4, 5, 2) and not np.array_equal(held.q[:, 1], linear.q[:, 1])
    motion = cartpole.motion(q, v)
    motion.step(u[0], u_end=u[1])
    assert np.array_equal(motion.q, linear.q[:, 1])


def test_the_log_of_an_actuator(run):
    model = run.model
    assert model.actuator is None
    commands = np.ones((5, 2))
    for own in (model, model.double):
        start, end = own.forces(commands)
        assert start.dtype == own.dtype and np.array_equal(start, commands) and np.array_equal(end, commands)
    q, v, u = states(model, 1)
    forced = model.rollout(q[0], v[0], np.repeat(u, 4, 0), commands=True)
    assert np.array_equal(forced.q, model.rollout(q[0], v[0], np.repeat(u, 4, 0)).q)


def test_the_range_of_the_training_data(run):
    model = run.model
    covered = model.range
    assert set(covered) == {"q", "v", "u"} and covered["q"].shape == (2, 2)
    middle = covered["q"].mean(1)
    assert model.inside(middle)
    assert not model.inside(middle + [100, 0])
    assert model.inside(np.stack([middle, middle + [100, 0]])).tolist() == [True, False]


def test_what_cannot_be_is_said(cartpole, tmp_path):
    q, v, _ = states(cartpole, 3)
    with pytest.raises(la.InputError, match=r"q has the shape \(3, 3\); its last axis must be 2"):
        cartpole.acceleration(np.zeros((3, 3)), v)
    with pytest.raises(la.InputError, match="do not fit each other"):
        cartpole.acceleration(q, v[:2])
    with pytest.raises(la.SolveError, match="state 1"):
        cartpole.acceleration(q, v * [[1], [np.nan], [1]])
    found = cartpole.acceleration(q, v * [[1], [np.nan], [1]], errors="nan")
    assert np.isnan(found).all(-1).tolist() == [False, True, False]
    found = cartpole.double.acceleration(q, v * [[1], [np.nan], [1]], errors="nan")
    assert np.isnan(found).all(-1).tolist() == [False, True, False]
    with pytest.raises(la.SolveError, match="state 1"):
        cartpole.double.acceleration(q, v * [[1], [np.nan], [1]])
    with pytest.raises(la.InputError, match="it must be 2 or 4"):
        cartpole.rollout(q, v, steps=1, order=3)
    with pytest.raises(la.InputError, match="say how many steps"):
        cartpole.rollout(q, v)
    with pytest.raises(la.InputError, match="h is 0"):
        cartpole.rollout(q, v, steps=1, h=0.0)
    with pytest.raises(la.InputError, match="missing.postcard"):
        la.load(tmp_path / "missing.postcard")
    (tmp_path / "damaged.postcard").write_bytes(b"LEASTACT" + cartpole.to_bytes()[8:-1])
    with pytest.raises(la.InputError, match="leastaction export"):
        la.load(tmp_path / "damaged.postcard")
    assert issubclass(la.InputError, ValueError) and issubclass(la.SolveError, la.Error)


def test_rollouts_that_break_off(cartpole):
    q, v, _ = states(cartpole, 3)
    v[1] = 1e30
    with pytest.raises(la.SolveError, match="state 1"):
        cartpole.rollout(q, v, steps=4)
    rolled = cartpole.rollout(q, v, steps=4, errors="nan")
    assert np.isfinite(rolled.q[[0, 2]]).all() and np.isnan(rolled.q[1, -1]).all()


def test_files(model, tmp_path):
    model.save(tmp_path / "m.postcard")
    q, v, u = states(model, 3)
    again = la.load(tmp_path / "m.postcard")
    assert np.array_equal(again.acceleration(q, v, u), model.acceleration(q, v, u))
    assert np.array_equal(pickle.loads(pickle.dumps(model)).acceleration(q, v, u), again.acceleration(q, v, u))
    assert np.array_equal(la.from_bytes(model.to_bytes()).weights, model.weights)
    (tmp_path / "log.csv").write_text("q0,t\n1,0\n")
    with pytest.raises(la.InputError, match="would be lost"):
        model.save(tmp_path / "log.csv")


def test_sources(cartpole, tmp_path):
    cartpole.save_rust(tmp_path / "m.rs")
    assert "pub fn load()" in (tmp_path / "m.rs").read_text()
    cartpole.save_c(tmp_path / "m.h", "pole")
    (tmp_path / "m.c").write_text(
        '#include "m.h"\n#include <stdio.h>\nint main(void) { return fwrite(pole, 1, POLE_BYTES, stdout) != POLE_BYTES; }\n'
    )
    compiler = next((c for c in ("cc", "gcc", "clang") if subprocess.run(["which", c], capture_output=True).returncode == 0), None)
    if compiler is None:
        pytest.skip("no C compiler")
    subprocess.run([compiler, "-std=c11", "-Wall", "-Werror", "-o", tmp_path / "m", tmp_path / "m.c"], check=True)
    written = subprocess.run([tmp_path / "m"], check=True, capture_output=True).stdout
    assert written == cartpole.to_bytes()


def test_half_precision(cartpole, tmp_path):
    cartpole.save(tmp_path / "half.postcard", half=True)
    half = la.load(tmp_path / "half.postcard")
    assert len(half.to_bytes()) < 0.6 * len(cartpole.to_bytes())
    known = la.load(MODELS / "cartpole-f16.postcard")
    assert np.array_equal(half.weights, known.weights)


def test_every_public_name_is_documented():
    for name in la.__all__:
        thing = getattr(la, name)
        if not isinstance(thing, str):
            assert thing.__doc__, name
    assert (Path(la.__file__).parent / "py.typed").exists()
