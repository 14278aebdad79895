"""Plans: from files, texts, dictionaries and models; the chip's motion; interruption."""

import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import REPOSITORY, check_threads_run, interruptible

import leastaction as la

FOLDER = REPOSITORY / "tests" / "peers" / "control"
PENDULUM = {
    "model": FOLDER / "pendulum.urdf",
    "tick": 0.01,
    "order": 2,
    "seconds": 4.0,
    "start": {"q": [np.pi]},
    "goal": {"q": [0.0]},
    "limits": {"u": [1.5]},
    "cost": {"u": [1.0]},
}


@pytest.fixture(scope="module")
def swing():
    return la.plan(FOLDER / "pendulum.toml")


def test_a_plan_meets_its_limits_and_its_goal(swing):
    assert swing.feasible and swing.worst is None and swing.violation < 1e-4
    assert swing.seconds == pytest.approx(4.0) and swing.t[-1] == pytest.approx(4.0)
    rows = len(swing.t)
    assert swing.q.shape == swing.v.shape == swing.u.shape == (rows, 1) and swing.gains.shape == (rows, 1, 2)
    assert swing.tube.shape == (rows - 1, 2)
    assert np.abs(swing.u).max() <= 1.5
    assert swing.q[0, 0] == pytest.approx(np.pi) and np.abs(np.sin(swing.q[-1, 0])) < 2e-4 and np.cos(swing.q[-1, 0]) > 0
    assert 0 < swing.iterations == swing.starts[0].iterations and len(swing.starts) == 8
    assert swing.cost == pytest.approx(0.5 * 0.01 * swing.ticks_per_node * (swing.u[:-1] ** 2).sum(), rel=1e-6)


def test_the_motion_is_the_chips(swing):
    model = swing.model
    u = np.repeat(swing.u[:-1], swing.ticks_per_node, 0)
    _, q, _ = model.rollout(swing.q[0], swing.v[0], u, h=swing.tick, order=swing.order)
    assert np.abs(q[:: swing.ticks_per_node] - swing.q).max() < 1e-5


def test_gains_bring_a_deviation_back(swing):
    left = {}
    for name, gain in (("followed", 1.0), ("not followed", 0.0)):
        motion = swing.model.motion(swing.q[0] + 0.05, swing.v[0], h=swing.tick, order=swing.order)
        for q, v, u, K in zip(swing.q[:-1], swing.v[:-1], swing.u[:-1], swing.gains[:-1]):
            u = u - gain * K @ np.concatenate([motion.q - q, motion.v - v])
            for _ in range(swing.ticks_per_node):
                motion.step(u)
        left[name] = np.abs(motion.q - swing.q[-1]).max()
    assert left["followed"] < 0.05 < left["not followed"], left


def test_every_way_to_configure_gives_the_same_plan(swing):
    model = swing.model
    limits = {"u": [1.5]}
    text = (FOLDER / "pendulum.toml").read_text().replace("pendulum.urdf", str(FOLDER / "pendulum.urdf"))
    plans = [
        la.plan(text),
        la.plan(PENDULUM),
        la.plan({**PENDULUM, "model": None}, model=model),
        la.plan(model=model, tick=0.01, order=2, seconds=4.0, start=np.pi, goal=[0.0], limits=limits, cost={"u": [1.0]}),
        la.plan(FOLDER / "pendulum.toml", model=model),
    ]
    for plan in plans:
        assert np.array_equal(plan.u, swing.u) and np.array_equal(plan.gains, swing.gains)


def test_a_guess_takes_the_place_of_start_guesses(swing):
    again = la.plan(PENDULUM, guess=swing.u[:-1])
    assert len(again.starts) == 1 and again.starts[0].guess == "given" and again.feasible
    assert again.iterations < swing.iterations and again.cost == pytest.approx(swing.cost, rel=1e-3)
    with pytest.raises(la.InputError, match="guess"):
        la.plan(PENDULUM, guess=np.zeros((5, 2)))


def test_a_plan_file(swing, tmp_path):
    swing.save(tmp_path / "plan.postcard")
    assert (tmp_path / "plan.postcard").read_bytes() == swing.to_bytes() and swing.to_bytes()[:4] == b"LAPN"
    (tmp_path / "other").write_text("something else")
    with pytest.raises(la.InputError):
        swing.save(tmp_path / "other")


def test_a_goal_out_of_reach_is_said(tmp_path):
    plan = la.plan({**PENDULUM, "seconds": 0.4})
    assert not plan.feasible and plan.worst and plan.violation > 0.1
    with pytest.raises(la.WorkError, match="no plan to be shipped"):
        plan.save(tmp_path / "plan.postcard")


def test_progress_and_exceptions():
    rows = []
    plan = la.plan({**PENDULUM, "search": {"starts": 2}}, callback=rows.append)
    assert {row.guess for row in rows} == {start.guess for start in plan.starts} and rows[0].nodes == len(plan.t) - 1
    assert sum(start.iterations for start in plan.starts) == len(rows)

    def fails(_):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        la.plan(PENDULUM, callback=fails)


def test_an_interruption_keeps_the_best_motion():
    def stops(row):
        if row.iteration == 3:
            raise KeyboardInterrupt

    plan = la.plan({**PENDULUM, "search": {"starts": 1}}, callback=stops)
    assert plan.interrupted and len(plan.u) == len(plan.t)


def test_ctrl_c():
    """SIGINT during a search in another process, without a callback, ends it with the motion so far."""
    program = (
        "import sys, leastaction as la\n"
        "print('begun', flush=True)\n"
        "plan = la.plan(sys.argv[1], model=None)\n"
        "print(plan.interrupted, len(plan.u) == len(plan.t))\n"
    )
    text = (FOLDER / "arm.toml").read_text().replace("arm.urdf", str(FOLDER / "arm.urdf")).replace("seconds = 1.42", "seconds = 1.39")
    process = subprocess.Popen([sys.executable, "-c", interruptible(program), text + "\n[search]\nstarts = 16\n"], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "begun\n"
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 0 and output == "True True\n"


def test_other_threads_run_meanwhile():
    check_threads_run(lambda: la.plan(PENDULUM))


def test_what_cannot_be_planned_is_said(swing):
    with pytest.raises(la.InputError, match="limits.u"):
        la.plan({**PENDULUM, "limits": {"u": [1.5, 2.0]}})
    with pytest.raises(la.InputError, match="no model"):
        la.plan(seconds=1.0)
    with pytest.raises(la.InputError, match="beside a configuration's text"):
        la.plan(FOLDER / "pendulum.toml", seconds=1.0)
    with pytest.raises(la.InputError, match="missing.toml"):
        la.plan("missing.toml")
    with pytest.raises(la.InputError, match="secnds"):
        la.plan({**PENDULUM, "secnds": 1.0})
