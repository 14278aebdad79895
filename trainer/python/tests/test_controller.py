"""Controllers: a weak pendulum from anywhere at any rate of calls, resets, configurations, errors; the example's acrobot."""

import runpy
import signal
import subprocess
import sys

import numpy as np
import pytest
from conftest import MODELS, REPOSITORY, check_threads_run, interruptible

import leastaction as la

# A rod of 1 m and 1 kg on a pivot, which hangs at 0; holding it level takes 4.9 N m.
PENDULUM = """<robot name="pendulum"><link name="base"/>
<link name="rod"><inertial><origin xyz="0 0 -0.5"/><mass value="1"/>
<inertia ixx="0.083" iyy="0.083" izz="0.083" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>"""
TICK, LIMIT = 0.01, 3.5
SWING_UP = {
    "tick": TICK,
    "ticks_per_node": 4,
    "seconds": 2.0,
    "start": [0.0],
    "goal": [np.pi],
    "limits": {"u": [LIMIT]},
    "policy": {"starts": 8},
}


@pytest.fixture(scope="module")
def urdf(tmp_path_factory):
    file = tmp_path_factory.mktemp("pendulum") / "pendulum.urdf"
    file.write_text(PENDULUM)
    return file


@pytest.fixture(scope="module")
def controller(urdf):
    return la.Controller(urdf, **SWING_UP)


def rate(x, u):
    return np.array([x[1], (u - 9.81 * 0.5 * np.sin(x[0])) / (0.083 + 0.25)])


def moved(x, u, h):
    """The state after h seconds by the classical Runge–Kutta method of order 4, in steps of at most 2.5 ms."""
    count = int(np.ceil(h / 0.0025))
    s = h / count
    for _ in range(count):
        k1 = rate(x, u)
        k2 = rate(x + s / 2 * k1, u)
        k3 = rate(x + s / 2 * k2, u)
        k4 = rate(x + s * k3, u)
        x = x + s / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return x


def simulated(controller, x, seconds, h=TICK, begin=0.0, timed=True):
    """States, commands and the law's states at all calls of a run with a call every h seconds."""
    rows = []
    for k in range(round(seconds / h)):
        u = controller(x[:1], x[1:], begin + k * h if timed else None)
        rows.append((x, u, controller.state, controller.searched))
        x = moved(x, u[0], h)
    x, u, state, searched = zip(*rows)
    return np.array(x), np.array(u), state, np.array(searched)


def off(x):
    """Largest distances from upright and from rest."""
    return np.abs(np.remainder(x[..., 0], 2 * np.pi) - np.pi).max(), np.abs(x[..., 1]).max()


@pytest.mark.parametrize("times", [1.0, 2.0, 1 / 3], ids=["a call a tick", "two calls a tick", "a call in three ticks"])
def test_a_weak_drive_swings_up_and_again_after_a_push_at_any_rate(controller, times):
    controller.reset()
    h = TICK / times
    x, u, state, searched = simulated(controller, np.zeros(2), 6.0, h)
    assert searched[0] and state[0] == "follow" and searched.sum() < 5
    assert np.abs(u).max() <= LIMIT and u.shape == (len(x), 1)
    last = x[-round(1 / h) :]
    assert off(last)[0] < 0.01 and off(last)[1] < 0.05, off(last)
    # A push, during which it is not asked: its clock goes on.
    x, _, _, searched = simulated(controller, x[-1] + [1.5, -4.0], 6.0, h, begin=6.2)
    assert searched.any()
    assert off(x[-round(1 / h) :])[0] < 0.01, off(x[-round(1 / h) :])


def test_a_motion_goes_on_with_the_time_and_not_with_the_calls(controller):
    """Commands of a motion at the same times are the same, however often it was asked in between."""
    x, u, _, _ = simulated(reset(controller), np.zeros(2), 0.5)
    reset(controller)
    for k, state in enumerate(x):
        for part in (0.0, 0.2, 0.4):
            assert controller(state[:1], state[1:], (k + part) * TICK) == u[k]
    reset(controller)
    for k in [0, 7, 30]:
        assert controller(x[k, :1], x[k, 1:], k * TICK) == u[k]


def reset(controller):
    controller.reset()
    assert controller.state is None and not controller.searched
    return controller


def test_a_reset_begins_anew_with_the_same_bits(controller):
    runs = [simulated(reset(controller), np.array([0.3, 1.0]), 2.0, timed=timed)[1] for timed in (True, True, False)]
    assert np.array_equal(runs[0], runs[1]) and np.array_equal(runs[0], runs[2])


def test_every_way_to_configure_gives_the_same_bits(controller, urdf, tmp_path):
    model = la.plan(model=urdf, **{**SWING_UP, "search": {"starts": 1}}).model
    tables = {**SWING_UP, "start": {"q": [0.0]}, "goal": {"q": [np.pi]}}
    text = (
        f"model = '{urdf}'\ntick = {TICK}\nticks_per_node = 4\nseconds = 2.0\nstart.q = [0.0]\ngoal.q = [{np.pi!r}]\n"
        f"limits.u = [{LIMIT}]\npolicy.starts = 8\n"
    )
    (tmp_path / "swing-up.toml").write_text(text)
    expected = simulated(reset(controller), np.zeros(2), 1.0)[1]
    for other in [
        la.Controller(model, SWING_UP),
        la.Controller(None, {**tables, "model": urdf}),
        la.Controller(config=tmp_path / "swing-up.toml"),
        la.Controller(config=text),
    ]:
        assert np.array_equal(other.seconds, controller.seconds) and len(other.seconds) > 1
        assert np.array_equal(simulated(other, np.zeros(2), 1.0)[1], expected)
    assert controller.tick == TICK and controller.n == 1 and controller.names == ["pivot"] and not controller.interrupted
    assert controller.low == [-LIMIT] and controller.high == [LIMIT] and controller.seconds.max() <= 2.0


def test_types(controller):
    reset(controller)
    u = controller([0.1], [0], 0)
    assert isinstance(u, np.ndarray) and u.dtype == np.float64 and u.shape == (1,)
    assert isinstance(controller.state, str) and isinstance(controller.searched, bool)
    for q, v in [(0.1, 0.0), (np.array([0.1]), (0.0,)), (np.float64(0.1), np.zeros(1, np.float32))]:
        assert np.array_equal(reset(controller).command(q, v), u)
    u[0] = 77.0
    assert controller.command(0.1, 0.0)[0] != 77.0
    assert f"{len(controller.seconds)} motions" in repr(controller)


def test_states_and_times_that_are_none_are_refused_and_change_nothing(controller):
    expected = simulated(reset(controller), np.zeros(2), 0.2)[1]
    reset(controller)
    again = []
    x = np.zeros(2)
    for k in range(20):
        again.append(controller(x[:1], x[1:], k * TICK))
        did = controller.state, controller.searched
        for wrong, word in [
            (([0.0, 1.0], [0.0], (k + 9) * TICK), r"q has the shape \(2,\)"),
            (([0.0], [[0.0]], (k + 9) * TICK), r"v has the shape \(1, 1\)"),
            (([np.nan], [0.0], (k + 9) * TICK), "NaN"),
            (([0.0], [np.inf], (k + 9) * TICK), "inf"),
            ((["a"], [0.0], (k + 9) * TICK), r"q is \['a'\]"),
            (([[0.0], [0.0, 1.0]], [0.0], (k + 9) * TICK), "q is"),
            (([0.0], [0.0], "now"), "t is 'now'"),
            (([0.0], [0.0], [1.0]), r"t has the shape \(1,\)"),
            (([0.0], [0.0], np.nan), "`t` is NaN"),
            (([0.0], [0.0], -1.0), "reset before a new run"),
            (([0.0], [0.0]), "in all of them or in none"),
        ]:
            with pytest.raises(la.InputError, match=word):
                controller(*wrong)
        assert (controller.state, controller.searched) == did
        x = moved(x, again[-1][0], TICK)
    assert np.array_equal(again, expected)
    # Time begins where a run begins.
    assert controller.state and reset(controller)([0.0], [0.0], -5.0) is not None


def test_what_has_no_controller_is_said(urdf):
    for keys, error, word in [
        ({"goal": [1.5]}, la.InputError, "goal"),
        ({"limits": {"u": [1.0, 2.0]}}, la.InputError, "limits.u"),
        ({"policy": {"starts": 0}}, la.InputError, "policy.starts"),
        ({"policy": {"start": 3}}, la.InputError, "start"),
        ({"limits": {"u": [0.01]}, "policy": {"starts": 1}}, la.WorkError, "no motion reaches the goal"),
    ]:
        with pytest.raises(error, match=word):
            la.Controller(urdf, {**SWING_UP, **keys})
    with pytest.raises(la.InputError, match="no model"):
        la.Controller(**SWING_UP)
    with pytest.raises(la.InputError, match="second argument"):
        la.Controller(SWING_UP)
    with pytest.raises(la.InputError, match="missing.urdf"):
        la.Controller("missing.urdf", SWING_UP)
    graph = la.load(MODELS / "pendulums.postcard")
    n = [0.0] * graph.n
    with pytest.raises(la.Error, match="graphs"):
        la.Controller(graph, seconds=1.0, tick=0.01, start=n, goal=n, limits={"u": [1.0] * graph.n}, policy={"starts": 1})


def test_a_learned_model_is_controlled():
    """A learned cart-pole whose pole hangs near its rest: the regulator alone catches it."""
    model = la.load(MODELS / "cartpole.postcard")
    controller = la.Controller(model, seconds=2.0, start=[0.0, 3.1], goal=[0.0, np.pi], limits={"u": [30.0, 0.0]}, policy={"starts": 1})
    assert controller.tick == pytest.approx(model.h)
    u = controller([0.0, 3.1], [0.0, 0.0])
    assert u.shape == (2,) and abs(u[0]) <= 30.0 and u[1] == 0.0


def test_progress_exceptions_and_interruption(urdf):
    rows = []
    la.Controller(urdf, SWING_UP, progress=rows.append)
    searched = [row.searched for row in rows]
    assert searched == sorted(searched) and searched[-1] == 8 and len(set(searched)) > 1 and {row.starts for row in rows} == {8}

    def fails(row):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        la.Controller(urdf, SWING_UP, progress=fails)

    def interrupts(row):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        la.Controller(urdf, {**SWING_UP, "limits": {"u": [0.01]}}, progress=interrupts)

    def stops(row):
        if row.searched >= 40:
            raise KeyboardInterrupt

    many = {**SWING_UP, "policy": {"starts": 400}}
    controller = la.Controller(urdf, many, progress=stops)
    assert controller.interrupted and 0 < len(controller.seconds) < 200
    assert abs(controller([0.0], [0.0])[0]) <= LIMIT


def test_ctrl_c(urdf):
    """SIGINT during a search in another process keeps what was found."""
    program = (
        "import sys, leastaction as la\n"
        "controller = la.Controller(sys.argv[1], tick=0.01, ticks_per_node=4, seconds=2.0, start=0.0, goal=3.141592653589793,"
        " limits={'u': [3.5]}, policy={'starts': 400}, progress=lambda row: print(row.searched, flush=True))\n"
        "print(controller.interrupted, len(controller.seconds) > 0)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", interruptible(program), str(urdf)], stdout=subprocess.PIPE, text=True)
    try:
        while int(process.stdout.readline()) < 100:
            pass
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 0 and output.splitlines()[-1] == "True True"


def test_other_threads_run_meanwhile(urdf):
    check_threads_run(lambda: la.Controller(urdf, SWING_UP))


@pytest.mark.parametrize("robot", ["acrobot", "pendubot"])
def test_the_examples_class_swings_up_from_near_by(robot):
    """The interface of RealAIGym with a library of one motion: only the driven joint has a torque."""
    example = runpy.run_path(str(REPOSITORY / "trainer" / "python" / "examples" / "acrobot.py"))
    start = [np.pi - 0.5, 0.3]
    anywhere = example["Anywhere"](robot, start=start, seconds=1.0, policy={**example["CONFIG"]["policy"], "starts": 1})
    assert len(anywhere.controller.seconds) == 1
    driven = {"acrobot": 1, "pendubot": 0}[robot]
    anywhere.init_()
    x = np.array([*start, 0.0, 0.0])
    states = []
    for k in range(1500):
        tau = anywhere.get_control_output_(x, 0.002 * k)
        states.append(anywhere.controller.state)
        assert tau.shape == (2,) and tau[1 - driven] == 0.0 and abs(tau[driven]) <= 6.0
        x = example["step"](x, tau, 0.002)
    assert "follow" in states and np.abs(x - [np.pi, 0.0, 0.0, 0.0]).max() < 0.05, (states[-1], x)
