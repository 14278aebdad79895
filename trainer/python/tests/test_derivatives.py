"""Exact derivatives: their values, and functions of PyTorch and JAX."""

import subprocess
import sys

import numpy as np
import pytest
from conftest import MODELS

import leastaction as la

FORCES = ["cartpole-dry", "cartpole", "double", "acrobot"]


def states(model, *lead, seed=0):
    random = np.random.default_rng(seed)
    return [0.4 * random.normal(size=(*lead, model.n)) for _ in range(3)]


def differences(function, at, width, step=1e-5):
    """Central differences of a function of q, v, u by all of their numbers, […, width, 3n]."""
    n, columns = at[0].shape[-1], []
    for k in range(3 * n):
        ends = []
        for sign in (1, -1):
            moved = [x.copy() for x in at]
            moved[k // n][..., k % n] += sign * step
            ends.append(function(*moved))
        columns.append((ends[0] - ends[1]) / (2 * step))
    return np.stack(columns, -1)


@pytest.fixture(params=FORCES)
def machine(request):
    return la.load(MODELS / f"{request.param}.postcard")


def test_jacobians_are_differences(machine):
    at = states(machine, 5, 7)
    found = machine.acceleration_jacobians(*at)
    expected = differences(machine.double.acceleration, at, machine.n)
    assert found.q.shape == (5, 7, machine.n, machine.n)
    assert np.allclose(np.concatenate(found, -1), expected, rtol=1e-6, atol=1e-6)
    for order in (2, 4):
        found = machine.step_jacobians(*at, h=0.02, order=order)
        end = lambda *at: np.concatenate(machine.double.step(*at, h=0.02, order=order), -1)  # noqa: B023, E731
        assert found.x.shape == (5, 7, 2 * machine.n, 2 * machine.n)
        expected = differences(end, at, 2 * machine.n)
        assert np.allclose(np.concatenate(found, -1), expected, rtol=1e-6, atol=1e-6)


def test_jacobians_are_those_of_a_single_state(cartpole):
    q, v, u = states(cartpole)
    single, many = cartpole.linearize(q, v, u), cartpole.acceleration_jacobians([q] * 40, v, u)
    assert np.allclose(many.q[39], single.acceleration_q, rtol=1e-12, atol=1e-12)
    assert np.allclose(many.u[39], single.acceleration_u, rtol=1e-12, atol=1e-12)
    chip, step = cartpole.linearize_step(q, v, u), cartpole.step_jacobians(q, v, u)
    assert np.allclose(step.x, chip.A, atol=1e-4) and np.allclose(step.u, chip.B, atol=1e-4)


def test_states_without_derivatives(cartpole):
    q, v, u = states(cartpole, 3)
    v[1] = np.nan
    with pytest.raises(la.SolveError, match="state 1"):
        cartpole.acceleration_jacobians(q, v, u)
    for found in (cartpole.acceleration_jacobians(q, v, u, errors="nan"), cartpole.step_jacobians(q, v, u, errors="nan")):
        assert np.isnan(found[0]).all((-1, -2)).tolist() == [False, True, False]
    with pytest.raises(la.InputError, match="h is 0"):
        cartpole.step_jacobians(q, v, h=0.0)
    with pytest.raises(la.InputError, match="its last axis must be 2"):
        cartpole.acceleration_jacobians(q[:, :1], v)
    with pytest.raises(la.InputError, match="rods of a model that is differentiated"):
        graph = la.load(MODELS / "pendulums.postcard")
        graph.acceleration_jacobians(np.ones(graph.n), np.zeros(graph.n))


@pytest.mark.parametrize("name", ["torch", "jax", "gymnasium"])
def test_a_missing_package_is_said(name):
    module = {"torch": "PyTorch", "jax": "JAX", "gymnasium": "gymnasium"}[name]
    program = (
        f"import sys; sys.modules[{name!r}] = None\n"
        "import leastaction\n"
        f"try:\n    import leastaction.{name}\nexcept ImportError as error:\n    print(error)\n"
    )
    said = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True, env={"PYTHONPATH": ":".join(sys.path)})
    assert said.stdout.strip() == f"leastaction.{name} needs {module}: pip install {name}"


def test_importing_the_package_imports_none_of_them():
    program = "import sys, leastaction; print([name for name in ('torch', 'jax', 'gymnasium') if name in sys.modules])"
    said = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True, env={"PYTHONPATH": ":".join(sys.path)})
    assert said.stdout.strip() == "[]"


def test_torch_gradients(machine):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    import leastaction.torch as lt

    at = [torch.tensor(x, requires_grad=True) for x in states(machine, 4)]
    a, step = lt.acceleration(machine), lt.step(machine, h=0.02)
    assert torch.autograd.gradcheck(a, at, check_batched_grad=True, check_forward_ad=True)
    assert torch.autograd.gradcheck(step, at, check_batched_grad=True, check_forward_ad=True)
    assert np.array_equal(a(*at).detach(), machine.double.acceleration(*(x.detach().numpy() for x in at)))


def test_torch_shapes_and_types(cartpole):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    import leastaction.torch as lt

    a, step = lt.acceleration(cartpole), lt.step(cartpole)
    q, v, u = (torch.tensor(x) for x in states(cartpole, 3))
    crossed = q[:, None].requires_grad_()
    a(crossed, v[None], u[0]).sum().backward()
    alone = torch.stack([torch.func.jacrev(lambda x: a(x, v, u[0]).sum())(one) for one in q])
    assert crossed.grad.shape == (3, 1, 2) and torch.allclose(crossed.grad[:, 0], alone)
    mapped = torch.func.vmap(torch.func.jacrev(a))(q, v, u)
    assert torch.allclose(mapped, torch.tensor(cartpole.acceleration_jacobians(q, v, u).q))
    single = step(q.float(), v.float())
    assert single[0].dtype == single[1].dtype == torch.float32 and single[0].shape == (3, 2)
    assert torch.isnan(a(q, v * float("nan"))).all()
    with pytest.raises(la.InputError, match="its last axis must be 2"):
        a(q[:, :1], v)
    with pytest.raises(NotImplementedError, match="first derivatives only"):
        torch.autograd.functional.hessian(lambda x: a(x, v, u).sum(), q)
    with pytest.raises(la.InputError, match="rods"):
        lt.acceleration(la.load(MODELS / "pendulums.postcard"))


def test_jax_gradients(machine):
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    jax.config.update("jax_enable_x64", True)
    from jax.test_util import check_grads

    import leastaction.jax as lj

    at = states(machine, 4)
    for function in (lj.acceleration(machine), lj.step(machine, h=0.02)):
        check_grads(function, at, order=1, modes=["fwd", "rev"])
        check_grads(jax.jit(jax.vmap(function)), at, order=1, modes=["fwd", "rev"])
    assert np.array_equal(lj.acceleration(machine)(*at), machine.double.acceleration(*at))


def test_jax_transformations(cartpole):
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    jax.config.update("jax_enable_x64", True)
    import leastaction.jax as lj

    a, step = lj.acceleration(cartpole), lj.step(cartpole)
    q, v, u = states(cartpole, 3)
    expected = cartpole.acceleration_jacobians(q, v, u)
    for jacobian in (jax.jacfwd, jax.jacrev):
        found = jax.jit(jax.vmap(jacobian(a, argnums=(0, 1, 2))))(q, v, u)
        assert all(np.allclose(one, other, rtol=1e-12) for one, other in zip(found, expected))
    crossed = jax.vmap(jax.vmap(a, (None, 0, None)), (0, None, None))(q, v, u[0])
    assert np.array_equal(crossed, cartpole.double.acceleration(q[:, None], v, u[0]))

    def rolled(controls):
        return jax.lax.scan(lambda x, u: (step(*x, u), None), (q[0], v[0]), controls)[0][0][1]

    controls = np.repeat(u[:1], 5, 0)
    check = jax.jit(jax.grad(rolled))(controls)
    moved = [(rolled(controls + d) - rolled(controls - d)) / 2e-5 for d in 1e-5 * np.eye(10).reshape(10, 5, 2)]
    assert np.allclose(check.ravel(), moved, atol=1e-7)
    assert a(q.astype(np.float32), v.astype(np.float32)).dtype == np.float32
    assert np.isnan(a(q, v * np.nan)).all()
    with pytest.raises(la.InputError, match="its last axis must be 2"):
        a(q[:, :1], v)
    with pytest.raises(NotImplementedError, match="first derivatives only"):
        jax.hessian(lambda x: a(x, v, u).sum())(q)
    with pytest.raises(la.InputError, match="rods"):
        lj.step(la.load(MODELS / "pendulums.postcard"), h=0.01)
