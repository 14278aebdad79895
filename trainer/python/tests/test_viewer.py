"""Motions drawn in notebooks and files."""

import html
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import MODELS

import leastaction as la

T = np.linspace(0.0, 3.0, 61)
ARM = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="shoulder" axis="0 0 1"/>
<inertial pos="0.2 0 0" mass="1" diaginertia="0.01 0.02 0.02"/><body pos="0.4 0 0"><joint name="elbow" axis="0 1 0"/>
<inertial pos="0.15 0 0" mass="0.5" diaginertia="0.005 0.01 0.01"/></body></body></worldbody></mujoco>"""


def swings(n):
    """Positions of n coordinates that swing at different frequencies, [samples, n]."""
    return np.stack([0.8 * np.sin((1 + i) * T) for i in range(n)], 1)


def data_of(view):
    return json.loads(re.search(r'id="data">(.*?)</script>', view.html, re.DOTALL)[1])


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "arm.xml").write_text(ARM)
    return la.from_description(tmp_path / "arm.xml")


def check_self_contained(page):
    assert page.startswith("<!DOCTYPE html>")
    for outside in ("src=", "href=", "@import", "url(", "import(", "fetch("):
        assert outside not in page, outside


def test_every_family_is_shown(model):
    q = swings(model.n)
    view = la.viewer.show(model, q, T)
    check_self_contained(view.html)
    data = data_of(view)
    assert np.allclose(data["motions"][0]["q"], q, atol=1e-5) and np.allclose(data["motions"][0]["t"], T)
    assert (data["scene"] is None) == (view.about is None) == bool(data["charts"])
    assert len(data["charts"]) in (0, model.n)


def test_a_cell_shows_the_page_in_a_frame_of_its_own(cartpole):
    view = la.viewer.show(cartpole, swings(2), T, title='a <b> & "c"')
    cell = view._repr_html_()
    page = html.unescape(re.fullmatch(r'<iframe srcdoc="([^"]*)" sandbox="allow-scripts"[^>]*></iframe>', cell)[1])
    assert page == view.html and "<title>a &lt;b&gt; &amp; &quot;c&quot;</title>" in page
    for part in ('id="play"', 'id="time" type="range"', 'id="speed"', 'id="clock"'):
        assert part in page


def test_points_are_those_of_the_mechanism(arm):
    """The hand of an arm that turns about z and then about its own y axis."""
    q = swings(2)
    data = data_of(la.viewer.show(arm, q, T))
    assert data["scene"]["spatial"] and [kind for kind, _ in data["scene"]["parts"]].count("pivot") == 2
    points = np.reshape(data["motions"][0]["points"], (len(T), -1, 3))
    yaw = np.stack([np.cos(q[:, 0]), np.sin(q[:, 0]), 0 * T], 1)
    tip = points[:, data["scene"]["tips"][0]]
    expected = (0.4 + 0.3 * np.cos(q[:, 1]))[:, None] * yaw - 0.3 * np.sin(q[:, 1])[:, None] * [0, 0, 1]
    assert np.allclose(tip, expected, atol=1e-5)
    assert np.allclose(points[:, 2], 0.4 * yaw, atol=1e-5)


def test_nodes_of_a_graph_are_where_their_coordinates_are():
    model = la.load(MODELS / "pendulums.postcard")
    q = np.tile([0.0, -1.0, 0.5, -2.0, 0.3, -2.5, 1.0, 1.0][: model.n], (len(T), 1)) + 0.1 * swings(model.n)
    data = data_of(la.viewer.show(model, q, T))
    points = np.reshape(data["motions"][0]["points"], (len(T), -1, 3))
    assert np.allclose(points[:, : model.n // 2, :2].reshape(len(T), -1), q, atol=1e-4)
    assert not data["scene"]["spatial"] and {kind for kind, _ in data["scene"]["parts"]} >= {"link", "pivot"}


def test_two_motions_are_laid_over_each_other(cartpole):
    q = swings(2)
    motion = cartpole.rollout(q[0], [0.0, 0.5], steps=40)
    data = data_of(la.viewer.show(cartpole, q, T + 7.0, beside=(q + 0.01)[:30], beside_t=T[:30] + 7.5, labels=("log", "</script>")))
    first, second = data["motions"]
    assert (first["label"], second["label"]) == ("log", "</script>") and len(data["charts"]) == 2
    assert first["t"][0] == 0 and np.isclose(second["t"][0], 0.5) and len(second["points"]) == 30
    rolled = data_of(la.viewer.show(cartpole, motion, charts=True))
    assert np.allclose(rolled["motions"][0]["t"], motion.t, atol=1e-6)
    log = {"q": q, "t": T}
    assert len(data_of(la.viewer.show(cartpole, log, beside=q))["motions"][1]["t"]) == len(T)


def test_long_motions_are_thinned(cartpole):
    t = np.arange(50_001) * 1e-3
    q = np.stack([np.sin(t), np.cos(t)], 1)
    motion = data_of(la.viewer.show(cartpole, q, t))["motions"][0]
    assert len(motion["t"]) <= la.viewer.MOST_FRAMES and motion["t"][-1] == 50.0
    assert np.allclose(motion["q"][-1], q[-1], atol=1e-4)


@pytest.mark.parametrize(
    "arguments, says",
    [
        ({"q": np.zeros((5, 3)), "t": np.arange(5)}, r"q has the shape \(5, 3\); it must be \[samples, 2\]"),
        ({"q": np.zeros((4, 5, 2)), "t": np.arange(5)}, "choose one of the motions side by side"),
        ({"q": np.zeros((1, 2)), "t": [0.0]}, "q has 1 samples; a motion has at least 2"),
        ({"q": [[0.0, 0.0], [0.0, np.nan]], "t": [0.0, 1.0]}, r"q is nan at sample 1, coordinate 1: draw the samples before it, q\[:1\]"),
        ({"q": [["a", "b"]]}, "q is not an array of numbers"),
        ({"q": np.zeros((3, 2)), "t": [0.0, 1.0]}, r"t has the shape \(2,\); the motion has 3 samples"),
        ({"q": np.zeros((3, 2)), "t": [0.0, 2.0, 1.0]}, "t goes from 2.0 to 1.0 s at sample 2; times increase"),
        ({"q": np.zeros((3, 2)), "t": [0.0, np.inf, 1.0]}, "t is inf at sample 1"),
        ({"q": np.zeros((3, 2)), "t": [0, 1, 2], "beside": np.zeros((2, 2))}, r"no times: give beside_t, \[2\], s"),
        ({"q": np.zeros((3, 2)), "t": [0, 1, 2], "beside_t": [0, 1, 2]}, "beside_t without beside"),
        ({"q": np.zeros((3, 2)), "t": [0, 1, 2], "labels": ["one"]}, "two names"),
        ({"q": np.zeros((3, 2)), "t": [0, 1, 2], "names": ["x"]}, "names has 1 entries; the model has 2"),
        ({"q": np.zeros((3, 2)), "t": [0, 1, 2], "speed": 0.0}, "speed is 0.0"),
    ],
)
def test_what_cannot_be_drawn_is_said(cartpole, arguments, says):
    with pytest.raises(la.InputError, match=says):
        la.viewer.show(cartpole, **arguments)


def test_files(cartpole, tmp_path):
    view = la.viewer.show(cartpole, swings(2), T)
    view.save(tmp_path / "motion.html")
    view.save(tmp_path / "motion.html")
    assert (tmp_path / "motion.html").read_text() == view.html
    (tmp_path / "other.html").write_text("mine")
    for name in ("motion.txt", "other.html"):
        with pytest.raises(la.InputError):
            view.save(tmp_path / name)
    assert (tmp_path / "other.html").read_text() == "mine"


def test_descriptions_are_exact_models(arm, tmp_path):
    a = arm.inverse_dynamics([0.3, 0.0], [0.0, 0.0], [0.0, 0.0])
    assert np.isclose(a[1], -9.81 * 0.5 * 0.15, rtol=1e-5) and arm.n == 2
    with pytest.raises(la.InputError, match="nowhere"):
        la.from_description(tmp_path / "nowhere.urdf")


@pytest.mark.parametrize("of", ["cartpole", "arm", "charts", "double", "pendulums", "acrobot"])
def test_a_browser_plays_it(of, arm, tmp_path):
    """Chromium plays, pauses, slides and turns a page; $VIEWER_PICTURES names a folder for pictures."""
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if browser is None or shutil.which("node") is None:
        pytest.skip("no Chromium, or no Node to speak with it")
    model = arm if of == "arm" else la.load(MODELS / f"{'cartpole' if of == 'charts' else of}.postcard")
    q = swings(model.n)
    if of == "pendulums":
        q = 0.1 * q + np.tile([0.5, -1.0], model.n // 2) * np.repeat(1 + np.arange(model.n // 2), 2)
    more = {"beside": q + 0.1, "charts": True} if of in ("charts", "arm") else {}
    la.viewer.show(model, q, T, **more).save(tmp_path / f"{of}.html")
    words = ["node", str(Path(__file__).with_name("browser.mjs")), browser, str(tmp_path / f"{of}.html")]
    words += filter(None, [os.environ.get("VIEWER_PICTURES")])
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert 0.8 < found["pace"] < 1.2 and found["time"] == found["slid"] == pytest.approx(1.5)
    assert found["turned"] == (of == "arm") and found["charts"] == (model.n if more else 0)
    assert sum(found["parts"]) > 3
