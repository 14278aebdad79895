"""JAX on one processor core in f64, with timed functions, for the comparisons. Import this module before JAX."""

import os
import sys
import time

# Must precede the start of JAX's threads: everything below runs on one core.
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["OMP_NUM_THREADS"] = "1"
os.environ["JAX_PLATFORMS"] = "cpu"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

try:
    import jax
    import jax.numpy as jnp
    import numpy as np
except ImportError as error:
    print(f"error: {error}: run `pip install jax` for the interpreter {sys.executable}", file=sys.stderr)
    sys.exit(2)

jax.config.update("jax_enable_x64", True)


class Timed:
    """A compiled function with its best wall and processor seconds and its first output.

    The function is called `calls` times in a row and does `units` units of work per call; times are per unit."""

    def __init__(self, name, function, arguments, calls=1, units=1):
        self.name, self.arguments, self.calls, self.units = name, arguments, calls, calls * units
        self.compiled = jax.jit(function).lower(*arguments).compile()
        self.output = jax.block_until_ready(self.compiled(*arguments))
        self.wall = self.cpu = np.inf

    def measure(self):
        wall, cpu = time.perf_counter(), time.process_time()
        for _ in range(self.calls):
            jax.block_until_ready(self.compiled(*self.arguments))
        self.cpu = min(self.cpu, (time.process_time() - cpu) / self.units)
        self.wall = min(self.wall, (time.perf_counter() - wall) / self.units)


def relative_error(got, expected):
    """‖Δ‖∞ / ‖expected‖∞."""
    got, expected = np.asarray(got), np.asarray(expected)
    return float(np.abs(got - expected).max() / np.abs(expected).max())
