"""Functional mock-up units, as an importer (FMPy) runs them: valid, with the package's bits, and with errors in words."""

import shutil
import subprocess

import numpy as np
import pytest
from conftest import FAMILIES, MODELS

import leastaction as la

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed, so no unit is run: pip install fmpy")
from fmpy import fmi2, fmi3  # noqa: E402
from fmpy.validation import validate_fmu  # noqa: E402

VERSIONS = [3, 2]
CARTPOLE = ["q[1]", "q[2]", "v[1]", "v[2]"]
START = {"q_start[1]": 0.1, "q_start[2]": 3.0, "v_start[1]": -0.2, "v_start[2]": 0.5}


def exported(command, folder, model="cartpole", version=3):
    unit = folder / f"{model}-{version}.fmu"
    command("export", MODELS / f"{model}.postcard", "--fmu", unit, "--fmi", version)
    return unit


@pytest.fixture(params=VERSIONS)
def unit(request, command, tmp_path):
    return exported(command, tmp_path, version=request.param)


class Loaded:
    """A unit in memory, from which instances are made; `said` has their messages."""

    def __init__(self, unit):
        self.description = fmpy.read_model_description(str(unit))
        self.folder = fmpy.extract(str(unit))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.said = []

    def instance(self, kind="coSimulation", token=None, **more):
        slave = kind == "coSimulation"
        is_3 = self.description.fmiVersion == "3.0"
        classes = (fmi3.FMU3Slave, fmi3.FMU3Model) if is_3 else (fmi2.FMU2Slave, fmi2.FMU2Model)
        instance = classes[0 if slave else 1](
            guid=token or self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="own",
        )
        if is_3:
            def take(environment, status, category, message):
                self.said.append(message.decode())

            instance.instantiate(logMessage=take, **more)
        else:
            def take(environment, name, status, category, message):
                self.said.append(message.decode())

            self.callbacks = fmi2.fmi2CallbackFunctions()
            self.callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(take)
            instance.instantiate(callbacks=self.callbacks, **more)
        return instance

    def started(self, kind="coSimulation", start=START):
        instance = self.instance(kind)
        self.set(instance, start)
        if self.description.fmiVersion == "3.0":
            instance.enterInitializationMode()
        else:
            instance.setupExperiment()
            instance.enterInitializationMode()
        instance.exitInitializationMode()
        return instance

    def set(self, instance, values):
        references = [self.references[name] for name in values]
        (instance.setFloat64 if hasattr(instance, "setFloat64") else instance.setReal)(references, list(values.values()))

    def get(self, instance, names):
        references = [self.references[name] for name in names]
        return list((instance.getFloat64 if hasattr(instance, "getFloat64") else instance.getReal)(references))

    def run(self, instance, controls, h, first=0):
        states = []
        for k, u in enumerate(controls, first):
            self.set(instance, {"u[1]": float(u)})
            instance.doStep(k * h, h)
            states.append(self.get(instance, CARTPOLE))
        return np.array(states)

    def refused(self, call, words):
        """Checks that a call fails, and that its message has these words."""
        before = len(self.said)
        with pytest.raises(Exception):
            call()
        assert words in " ".join(self.said[before:]), self.said[before:]


@pytest.fixture
def loaded(unit):
    loaded = Loaded(unit)
    yield loaded
    shutil.rmtree(loaded.folder, ignore_errors=True)


def controls(steps):
    return np.sin(0.013 * np.arange(steps)).astype(np.float32)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("family", [family for family in FAMILIES if family != "graph"])
def test_units_of_every_family_are_valid_and_run(command, tmp_path, family, version):
    unit = exported(command, tmp_path, FAMILIES[family], version)
    assert validate_fmu(str(unit)) == []
    model = la.load(MODELS / f"{FAMILIES[family]}.postcard")
    h = model.h or 0.001
    for kind in ["CoSimulation", "ModelExchange"]:
        outputs = [f"q[{i + 1}]" for i in range(model.n)] + ["energy"]
        found = fmpy.simulate_fmu(str(unit), fmi_type=kind, stop_time=20 * h, output_interval=h, output=outputs)
        assert found["time"][-1] == pytest.approx(20 * h) and np.isfinite(found["energy"]).all()
        if kind == "CoSimulation":
            motion = model.rollout(np.zeros(model.n), np.zeros(model.n), steps=20, h=h)
            q = np.stack([found[f"q[{i + 1}]"] for i in range(model.n)], axis=1)
            assert np.array_equal(q.astype(np.float32), motion.q)


def test_co_simulation_has_the_bits_of_the_package(loaded, cartpole):
    steps = 10_000
    u = controls(steps)
    found = loaded.run(loaded.started(), u, cartpole.h)
    force = np.stack([u, np.zeros_like(u)], axis=1)
    motion = cartpole.rollout([0.1, 3.0], [-0.2, 0.5], force)
    expected = np.concatenate([motion.q, motion.v], axis=1)[1:]
    assert expected.dtype == np.float32 and np.ptp(expected[:, 1]) > 0.5
    assert np.array_equal(found, expected.astype(float))


def test_a_communication_step_may_have_many_steps(loaded, cartpole):
    h = cartpole.h
    coarse = loaded.started()
    coarse.doStep(0.0, 7 * h)
    coarse.doStep(7 * h, 3 * h)
    fine = loaded.run(loaded.started(), np.zeros(10), h)
    assert loaded.get(coarse, CARTPOLE) == fine[-1].tolist()


def test_outputs_belong_to_the_state(loaded, cartpole):
    instance = loaded.started()
    loaded.set(instance, {"u[1]": 0.7})
    instance.doStep(0.0, cartpole.h)
    q1, q2, v1, v2 = loaded.get(instance, CARTPOLE)
    names = ["a[1]", "a[2]", "kinetic_energy", "potential_energy", "energy", "h", "u[1]"]
    a1, a2, kinetic, potential, energy, h, u = loaded.get(instance, names)
    assert [a1, a2] == cartpole.acceleration([q1, q2], [v1, v2], [0.7, 0.0]).astype(float).tolist()
    assert (kinetic, potential) == tuple(map(float, cartpole.energies([q1, q2], [v1, v2])))
    assert energy == kinetic + potential and h == cartpole.h and u == 0.7


def test_a_restored_state_continues_with_the_same_bits(loaded, cartpole):
    h, u = cartpole.h, controls(60)
    is_3 = loaded.description.fmiVersion == "3.0"
    instance = loaded.started()
    loaded.run(instance, u[:20], h)
    get, restore, free = (
        (instance.getFMUState, instance.setFMUState, instance.freeFMUState)
        if is_3
        else (instance.getFMUstate, instance.setFMUstate, instance.freeFMUstate)
    )
    to_bytes, of_bytes = (
        (instance.serializeFMUState, instance.deserializeFMUState)
        if is_3
        else (instance.serializeFMUstate, instance.deSerializeFMUstate)
    )
    state = get()
    kept = to_bytes(state)
    ahead = loaded.run(instance, u[20:], h, 20)
    restore(state)
    assert np.array_equal(loaded.run(instance, u[20:], h, 20), ahead)
    free(state)
    # The bytes continue in another instance, too.
    other = loaded.started(start={})
    state = of_bytes(kept)
    (other.setFMUState if is_3 else other.setFMUstate)(state)
    assert np.array_equal(loaded.run(other, u[20:], h, 20), ahead)
    damaged = bytes([kept[0] ^ 1]) + kept[1:]
    loaded.refused(lambda: of_bytes(damaged), "no undamaged state")


def test_instances_do_not_disturb_each_other(loaded, cartpole):
    h, u = cartpole.h, controls(50)
    alone = loaded.run(loaded.started(), u, h)
    one, two = loaded.started(), loaded.started(start={**START, "q_start[2]": 1.0})
    for k in range(50):
        first = loaded.run(one, u[k : k + 1], h, k)
        second = loaded.run(two, -u[k : k + 1], h, k)
        assert np.array_equal(first[0], alone[k]) and not np.array_equal(second[0], alone[k])


def test_model_exchange_agrees_with_an_adaptive_solver(unit, cartpole):
    from scipy.integrate import solve_ivp

    found = fmpy.simulate_fmu(
        str(unit), fmi_type="ModelExchange", stop_time=1.0, output_interval=0.1, relative_tolerance=1e-6,
        start_values=START, output=CARTPOLE,
        input=np.array([(0.0, 0.5), (1.0, 0.5)], dtype=[("time", float), ("u[1]", float)]),
    )

    def rate(_, x):
        return [*x[2:], *cartpole.double.acceleration(x[:2], x[2:], [0.5, 0.0])]

    exact = solve_ivp(rate, (0.0, 1.0), [0.1, 3.0, -0.2, 0.5], rtol=1e-10, atol=1e-12, t_eval=found["time"].clip(0, 1))
    for row, name in zip(exact.y, CARTPOLE):
        assert np.abs(found[name] - row).max() < 2e-4, name


def test_bad_calls_are_refused_in_words_and_change_nothing(loaded, cartpole):
    h = cartpole.h
    instance = loaded.started()
    instance.doStep(0.0, h)
    before = loaded.get(instance, CARTPOLE + ["time", "u[1]"])
    is_3 = loaded.description.fmiVersion == "3.0"
    get, put = (instance.getFloat64, instance.setFloat64) if is_3 else (instance.getReal, instance.setReal)
    put_other = instance.setInt32 if is_3 else instance.setInteger
    force = loaded.references["u[1]"]
    for call, words in [
        (lambda: get([999]), "no variable has the value reference 999"),
        (lambda: put([force, 77_777], [1.0, 1.0]), "no variable has the value reference 77777"),
        (lambda: put([force], [np.nan]), "u[1] is NaN"),
        (lambda: put([force], [1e300]), "no number of single precision"),
        (lambda: put([loaded.references["q[1]"]], [0.0]), "q_start and v_start set the state before the start"),
        (lambda: put([loaded.references["q_start[1]"]], [0.0]), "q_start[1] must not be set in step mode"),
        (lambda: put([loaded.references["h"]], [0.5]), "h must not be set"),
        (lambda: put([loaded.references["energy"]], [0.5]), "energy must not be set"),
        (lambda: put_other([force], [1]), "no variable of type"),
        (lambda: instance.doStep(h, 1.5 * h), "no whole multiple"),
        (lambda: instance.doStep(h, 0.5 * h), "no whole multiple"),
        (lambda: instance.doStep(h, -h), "must be 0 or longer"),
        (lambda: instance.doStep(h, np.inf), "the communication step is inf"),
        (lambda: instance.doStep(5 * h, h), "but the unit is at"),
        (lambda: instance.enterInitializationMode(), "not allowed in step mode"),
    ]:
        loaded.refused(call, words)
        assert loaded.get(instance, CARTPOLE + ["time", "u[1]"]) == before, words
    instance.doStep(h, h)
    instance.terminate()
    loaded.refused(lambda: instance.doStep(2 * h, h), "not allowed after the end")
    instance.reset()
    loaded.refused(lambda: instance.doStep(0.0, h), "not allowed before the initialisation")


def test_a_step_that_cannot_be_solved_is_an_error_and_changes_nothing(loaded, cartpole):
    instance = loaded.started()
    before = loaded.get(instance, CARTPOLE)
    loaded.set(instance, {"u[1]": 3e38})
    loaded.refused(lambda: instance.doStep(0.0, 5 * cartpole.h), "the step from t = ")
    assert loaded.get(instance, CARTPOLE + ["time"]) == [*before, 0.0]
    loaded.set(instance, {"u[1]": 0.0})
    instance.doStep(0.0, cartpole.h)


def test_interfaces_are_kept_apart(loaded, cartpole):
    model = loaded.started("modelExchange")
    x = (fmi3.fmi3Float64 * 4)() if loaded.description.fmiVersion == "3.0" else (fmi2.fmi2Real * 4)()
    loaded.refused(lambda: model.setContinuousStates(x, 3), "needs 4 numbers, not 3")
    x[2] = np.nan
    loaded.refused(lambda: model.setContinuousStates(x, 4), "v[1] is NaN")
    loaded.refused(lambda: model.completedIntegratorStep(), "not allowed in event mode")


def test_wrong_resources_are_refused(loaded):
    loaded.refused(lambda: loaded.instance(token="{other}"), "the instantiation token is")
    model = f"{loaded.folder}/resources/m.postcard"
    whole = open(model, "rb").read()
    with open(model, "wb") as file:
        file.write(whole[:-9])
    loaded.refused(loaded.instance, "the model in the unit's resources")
    shutil.rmtree(f"{loaded.folder}/resources")
    loaded.refused(loaded.instance, "m.postcard: No such file")


def test_the_command_refuses_what_is_no_unit(command, tmp_path):
    for model, words in [("pendulums", "a graph has particles")]:
        with pytest.raises(subprocess.CalledProcessError) as refused:
            exported(command, tmp_path, model)
        assert words in refused.value.stdout + refused.value.stderr
