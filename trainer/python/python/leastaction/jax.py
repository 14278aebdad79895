"""Accelerations and steps of a model as functions of JAX, with exact derivatives.

    import jax
    import leastaction as la
    import leastaction.jax as lj

    jax.config.update("jax_enable_x64", True)       # else results are rounded to float32
    step = jax.jit(lj.step(la.load("m.postcard"), h=0.01))
    q1, v1 = step(q, v, u)                          # arrays […, n]; grad, jacfwd, jacrev, vmap, jit and scan work

The model computes in double precision on the host; results have the type of the arguments. Second derivatives are refused. A state
without a value gives NaN. The weights of the model are constants here: `la.train` learns them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

try:
    import jax  # type: ignore[import-not-found,unused-ignore]
    import jax.numpy as jnp  # type: ignore[import-not-found,unused-ignore]
except ImportError:
    raise ImportError("leastaction.jax needs JAX: pip install jax") from None

from . import _differentiable
from ._differentiable import Map
from ._model import Model


def acceleration(model: Model) -> Callable[..., jax.Array]:
    """The function a(q, v, u=0) of arrays […, n] that broadcast: v̇, […, n], m/s² or rad/s², under the force u, N or N m.

    InputError if the model has rods.
    """
    of = _differentiable.acceleration(model)
    values = _values(of)

    def a(q: Any, v: Any, u: Any = None) -> jax.Array:
        return values(*_arguments(of, q, v, u))

    return a


def step(
    model: Model, h: float | None = None, order: int | None = None
) -> Callable[..., tuple[jax.Array, jax.Array]]:
    """The function step(q, v, u=0) of arrays […, n] that broadcast: position and velocity after a step of the discrete Euler–Lagrange
    equation under the held force u, […, n] each. h (s) and order (2 or 4) are by default those of training.

    InputError if the model has rods, or no step of its own and none is given.
    """
    of = _differentiable.step(model, h, order)
    values = _values(of)

    def end(q: Any, v: Any, u: Any = None) -> tuple[jax.Array, jax.Array]:
        x = values(*_arguments(of, q, v, u))
        return x[..., : of.n], x[..., of.n :]

    return end


def _arguments(of: Map, q: Any, v: Any, u: Any) -> list[jax.Array]:
    given = [jnp.asarray(x) for x in (q, v, jnp.zeros_like(q) if u is None else u)]
    of.check([x.shape for x in given])
    kind = jnp.result_type(*given, jnp.float32)
    return [x.astype(kind) for x in jnp.broadcast_arrays(*given)]


def _values(of: Map) -> Callable[..., jax.Array]:
    """The map as a function of JAX. Its change is linear in those of the arguments, so that JAX transposes it for reverse mode."""

    @jax.custom_jvp
    def values(*state: jax.Array) -> jax.Array:
        return _called(of.values, state, (of.width,))

    @values.defjvp
    def moved(state: Any, changes: Any) -> tuple[jax.Array, jax.Array]:
        jacobians = _jacobians(of)(*state)
        return values(*state), jnp.einsum("...ij,...j->...i", jacobians, jnp.concatenate(changes, -1))

    return values


def _jacobians(of: Map) -> Callable[..., jax.Array]:
    """The derivatives of a map, which themselves have none."""

    @jax.custom_jvp
    def jacobians(*state: jax.Array) -> jax.Array:
        return _called(of.jacobians, state, (of.width, 3 * of.n))

    @jacobians.defjvp
    def moved(state: Any, changes: Any) -> tuple[jax.Array, jax.Array]:
        raise NotImplementedError("leastaction.jax has first derivatives only; use jax.lax.stop_gradient, or differences")

    return jacobians


def _called(of: Callable[..., Any], state: tuple[jax.Array, ...], tail: tuple[int, ...]) -> jax.Array:
    """Calls a function of arrays of numpy from within compiled code."""
    kind = state[0].dtype
    shape = jax.ShapeDtypeStruct(state[0].shape[:-1] + tail, kind)
    result: jax.Array = jax.pure_callback(
        lambda *at: of(*at).astype(kind), shape, *state, vmap_method="broadcast_all"
    )
    return result


__all__ = ["acceleration", "step"]
