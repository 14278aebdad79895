"""Accelerations and steps of a model as functions of PyTorch, with exact derivatives.

    import leastaction as la
    import leastaction.torch as lt

    step = lt.step(la.load("m.postcard"), h=0.01)
    q1, v1 = step(q, v, u)                          # tensors […, n]; q1.sum().backward() reaches q, v and u

The model computes in double precision on the host; results have the type and the device of the arguments. `torch.func.vmap`, `grad` and
`jacrev` work; second derivatives are refused. A state without a value gives NaN. The weights of the model are constants here: `la.train`
learns them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Optional

try:
    import torch  # type: ignore[import-not-found,unused-ignore]
    from torch import Tensor  # type: ignore[import-not-found,unused-ignore]
except ImportError:
    raise ImportError("leastaction.torch needs PyTorch: pip install torch") from None

from . import _differentiable
from ._differentiable import Map
from ._model import Model


def acceleration(model: Model) -> Callable[..., Tensor]:
    """The function a(q, v, u=0) of tensors […, n] that broadcast: v̇, […, n], m/s² or rad/s², under the force u, N or N m.

    InputError if the model has rods.
    """
    of = _differentiable.acceleration(model)

    def a(q: Tensor, v: Tensor, u: Optional[Tensor] = None) -> Tensor:
        return _call(of, q, v, u)

    return a


def step(model: Model, h: float | None = None, order: int | None = None) -> Callable[..., tuple[Tensor, Tensor]]:
    """The function step(q, v, u=0) of tensors […, n] that broadcast: position and velocity after a step of the discrete Euler–Lagrange
    equation under the held force u, […, n] each. h (s) and order (2 or 4) are by default those of training.

    InputError if the model has rods, or no step of its own and none is given.
    """
    of = _differentiable.step(model, h, order)

    def end(q: Tensor, v: Tensor, u: Optional[Tensor] = None) -> tuple[Tensor, Tensor]:
        x = _call(of, q, v, u)
        return x[..., : of.n], x[..., of.n :]

    return end


def _call(of: Map, q: Tensor, v: Tensor, u: Optional[Tensor]) -> Tensor:
    state = [q, v, torch.zeros_like(q) if u is None else u]
    of.check([tuple(x.shape) for x in state])
    result: Tensor = _Values.apply(of, *torch.broadcast_tensors(*state))
    return result


def _computed(of: Callable[..., Any], state: tuple[Tensor, ...]) -> Tensor:
    """Calls a function of arrays of numpy; the result has the type and the device of the arguments."""
    kind = torch.promote_types(torch.promote_types(state[0].dtype, state[1].dtype), state[2].dtype)
    found = torch.from_numpy(of(*(x.detach().cpu().double().numpy() for x in state)))
    return found.to(dtype=kind, device=state[0].device)


def _batched(function: Any, in_dims: tuple[Any, ...], of: Map, state: tuple[Tensor, ...]) -> tuple[Tensor, int]:
    """The rule of `vmap`: all leading axes hold states side by side."""
    size = next(x.shape[axis] for x, axis in zip(state, in_dims[1:]) if axis is not None)
    moved = (x.expand(size, *x.shape) if axis is None else x.movedim(axis, 0) for x, axis in zip(state, in_dims[1:]))
    return function.apply(of, *moved), 0


class _Values(torch.autograd.Function):
    """The results of a map."""

    @staticmethod
    def forward(of: Map, *state: Tensor) -> Tensor:
        return _computed(of.values, state)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:
        ctx.of = inputs[0]
        ctx.save_for_backward(*inputs[1:])
        ctx.save_for_forward(*inputs[1:])

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Optional[Tensor], ...]:
        jacobians = _Jacobians.apply(ctx.of, *ctx.saved_tensors)
        return (None, *(gradient.unsqueeze(-2) @ jacobians).squeeze(-2).split(ctx.of.n, -1))

    @staticmethod
    def jvp(ctx: Any, _: Any, *changes: Tensor) -> Tensor:
        jacobians = _Jacobians.apply(ctx.of, *ctx.saved_tensors)
        result: Tensor = (jacobians @ torch.cat(changes, -1).unsqueeze(-1)).squeeze(-1)
        return result

    @staticmethod
    def vmap(info: Any, in_dims: tuple[Any, ...], of: Map, *state: Tensor) -> tuple[Tensor, int]:
        return _batched(_Values, in_dims, of, state)


class _Jacobians(torch.autograd.Function):
    """The derivatives of a map, which themselves have none."""

    @staticmethod
    def forward(of: Map, *state: Tensor) -> Tensor:
        return _computed(of.jacobians, state)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Tensor) -> None:
        pass

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Optional[Tensor], ...]:
        raise NotImplementedError("leastaction.torch has first derivatives only; detach the gradient, or take differences of it")

    @staticmethod
    def vmap(info: Any, in_dims: tuple[Any, ...], of: Map, *state: Tensor) -> tuple[Tensor, int]:
        return _batched(_Jacobians, in_dims, of, state)


__all__ = ["acceleration", "step"]
