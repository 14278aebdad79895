"""Numbers of a model that follow a log: what a machine carries, and how its friction changed."""

import numpy as np
import pytest

import leastaction as la

ROBOT = """<robot name="r"><link name="base"/>
<link name="column"><inertial><origin xyz="0 0 0.2"/><mass value="3"/>
<inertia ixx="0.03" iyy="0.03" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>
<inertia ixx="0.01" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="{x} 0 0"/><mass value="{mass}"/>
<inertia ixx="0.01" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="yaw" type="revolute"><parent link="base"/><child link="column"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint>
<joint name="shoulder" type="revolute"><parent link="column"/><child link="upper"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" velocity="9" effort="90"/></joint></robot>"""

H = 0.01
CONFIG = '[data]\nfile = "{file}"\ncontrol = "linear"\n[model]\ncoordinates = "aaa"\nhidden = [4]\n'


def arm(folder, load):
    """The arm, with a load of this mass, kg, at 0.3 m from its elbow."""
    mass = 1.0 + load
    x = (0.15 + load * 0.3) / mass
    i = 0.02 + (x - 0.15) ** 2 + load * (x - 0.3) ** 2
    file = folder / f"arm-{load}.urdf"
    file.write_text(ROBOT.format(mass=mass, x=x, i=i))
    return la.from_description(file)


def motion(n, seconds=20.0):
    t = np.arange(0, seconds, H)[:, None]
    rates = np.array([1.1, 2.3, 3.7])
    phase = rates * (t[..., None] + 1.3 * np.arange(n)[None, :, None])
    return tuple(0.6 * x.sum(-1) for x in (np.sin(phase) / rates, np.cos(phase), -rates * np.sin(phase)))


def log_of(machine, seed=0):
    q, v, a = motion(machine.n)
    u = machine.double.inverse_dynamics(q, v, a)
    return la.Log(q=q, v=v, u=u + np.random.default_rng(seed).uniform(-0.05, 0.05, u.shape), h=H, control="linear")


def test_a_load_is_found_and_the_model_carries_it(tmp_path):
    model, loaded = arm(tmp_path, 0.0), arm(tmp_path, 2.0)
    log = log_of(loaded)
    found = la.adapt(model, log, page=tmp_path / "page.html")
    assert abs(found.mass - 2.0) < max(4 * found.standard_error, 0.02) and found.standard_error < 0.05
    assert found.announced and 0 < found.seconds_to_announce < 5 and not found.unlike
    assert found.nmse_after < 0.1 * found.nmse_before
    windows, numbers = len(found.times), len(found.numbers)
    assert numbers == 10 and windows > 50 and np.all(np.diff(found.times) > 0)
    assert found.estimates.shape == found.standard_errors.shape == found.used.shape == (windows, numbers)
    assert found.residuals.shape == (windows, 3) and found.moving.shape == (windows,)
    first = found.numbers[0]
    assert (first.name, first.unit, first.model) == ("m of body 2", "kg", 1.0)
    ends = np.float32([first.distance, found.mass, first.standard_error, found.standard_error, first.used])
    (e, s, used) = (of[-1, 0] for of in (found.estimates, found.standard_errors, found.used))
    assert np.array_equal(ends, [e, e, s, s, used])
    assert found.standard_errors[-1, 0] < 0.1 * first.prior
    # The adapted model has the loaded machine's torques.
    q, v, a = motion(3)
    theirs = loaded.inverse_dynamics(q, v, a)
    off = [np.abs(of.inverse_dynamics(q, v, a) - theirs).max() for of in (model, found.model)]
    assert off[1] < 0.1 * off[0]
    found.model.save(tmp_path / "adapted.postcard")
    assert np.array_equal(la.load(tmp_path / "adapted.postcard").weights, found.model.weights)
    assert "Mass attached to body 2" in (tmp_path / "page.html").read_text()
    assert any("taken from this log" in note for note in found.notes) and "attached 2." in str(found)


def test_it_is_the_commands(command, tmp_path):
    model, right, loaded = arm(tmp_path, 0.0), tmp_path / "right.npz", tmp_path / "loaded.npz"
    model.save(tmp_path / "m.postcard")
    log_of(model, 1).write(right)
    log = log_of(arm(tmp_path, 1.0), 2)
    log.write(loaded)
    config = tmp_path / "arm.toml"
    config.write_text(CONFIG.format(file=right))
    theirs = command("adapt", tmp_path / "m.postcard", "--data", loaded, "--config", config, "--body", 2, "--memory", 10)
    for data in (loaded, log):
        ours = la.adapt(model, data, config=config, body=2, memory=10)
        assert theirs.keys() == ours.report.keys()
        for name in theirs.keys() - {"model", "log"}:
            assert theirs[name] == ours.report[name], name
    plain = la.adapt(model, log, config=config, mass=1.0, friction=False, window=0.5, false_alarms=1e-2)
    words = ["--mass", 1, "--no-friction", "--window", 0.5, "--false-alarms", 0.01]
    theirs = command("adapt", tmp_path / "m.postcard", "--data", loaded, "--config", config, *words)
    assert plain.report["numbers"] == theirs["numbers"] and plain.seconds_to_announce == theirs["seconds_to_announce"]


def test_friction_alone_follows(log, tmp_path):
    """A run of a network with friction: its own log says how uncertain it is."""
    config = {"data": {"file": log}, "model": {"coordinates": "ta", "hidden": [8], "friction": {"viscous": 0.3}}}
    config["training"] = {"iterations": 6, "warm_up": 4, "threads": 2}
    run = la.train(config, tmp_path / "run", progress=False)
    found = la.adapt(run, log, window=0.5)
    assert found.mass is None and found.standard_error is None and not found.announced
    assert [number.name for number in found.numbers] == ["b of coordinate 0", "b of coordinate 1"]
    assert [number.model for number in found.numbers] == pytest.approx([0.3, 0.3])
    assert not any("taken from this log" in note for note in found.notes)
    adapted = np.array([number.used for number in found.numbers])
    assert np.abs(adapted).max() > 0 and not np.array_equal(found.model.weights, run.model.weights)


def test_what_cannot_be_is_said(tmp_path, cartpole):
    with pytest.raises(la.InputError, match="no number that can follow"):
        la.adapt(cartpole, log_of(cartpole))
    model = arm(tmp_path, 0.0)
    log = log_of(model)
    with pytest.raises(la.InputError, match="no body 3"):
        la.adapt(model, log, body=3)
    with pytest.raises(la.InputError, match="memory must be"):
        la.adapt(model, log, memory=0.0)
    with pytest.raises(la.InputError, match="name a page"):
        la.adapt(model, log, page=tmp_path / "page.txt")
    with pytest.raises(la.InputError, match="no commands"):
        la.adapt(model, la.Log(q=log.q, h=H))
    with pytest.raises(la.InputError, match="coordinates"):
        la.adapt(model, la.Log(q=log.q[:, :1], u=log.u[:, :1], h=H))
