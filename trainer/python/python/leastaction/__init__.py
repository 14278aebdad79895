"""Learn the energies of a mechanical system from logged motion, and step it bit for bit as a microcontroller does.

    import leastaction as la

    run = la.train("robot.toml", "run")             # like `leastaction train robot.toml -o run`
    model = run.model                               # or la.load("m.postcard")
    a = model.acceleration(q, v, u)                 # q, v, u: […, n]; float32, the chip's bits
    t, q, v = model.rollout(q0, v0, u)              # u: […, steps, n]

Units are SI; angles are in radians.
"""

from ._levels import choose as _choose

_choose()

# ruff: noqa: E402, I001
from ._adaptation import Adaptation, AdaptedNumber, adapt
from ._controller import Controller, LibraryProgress
from ._environment import Environment
from ._errors import Error, InputError, SolveError, WorkError
from ._interop import from_lgnn, from_modlanet, from_symo
from ._leastaction import __version__, defaults
from ._logs import Evaluation, Log, Look, evaluate, look, report
from ._model import AccelerationJacobians, Model, Motion, StepJacobians, StepReport, Trajectory, from_bytes, from_description, load
from ._observer import Observer
from ._planning import Plan, PlanProgress, Start, plan
from ._regulators import Linearization, LinearStep, Regulator, RestRegulator, lqr
from ._training import Progress, Run, open_run, train
from . import viewer

__all__ = [
    "AccelerationJacobians",
    "Adaptation",
    "AdaptedNumber",
    "Controller",
    "Environment",
    "Error",
    "Evaluation",
    "InputError",
    "LibraryProgress",
    "LinearStep",
    "Linearization",
    "Log",
    "Look",
    "Model",
    "Motion",
    "Observer",
    "Plan",
    "PlanProgress",
    "Progress",
    "Regulator",
    "RestRegulator",
    "Run",
    "SolveError",
    "Start",
    "StepJacobians",
    "StepReport",
    "Trajectory",
    "WorkError",
    "__version__",
    "adapt",
    "defaults",
    "evaluate",
    "from_bytes",
    "from_description",
    "from_lgnn",
    "from_modlanet",
    "from_symo",
    "load",
    "look",
    "lqr",
    "open_run",
    "plan",
    "report",
    "train",
    "viewer",
]
