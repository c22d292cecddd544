"""Laws by name: built in, installed by another distribution, or where ``module:Class`` or ``file.py:Class`` points."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from inspect import isabstract
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from space_robot_control.laws.base import Law
from space_robot_control.laws.policy import TYPED, LawPolicy
from space_robot_description.robot import Robot
from space_robot_description.spec import Strict
from space_robot_description.validation import nearest, validate
from space_robot_msgs_py.bounded_files import is_file, short
from space_robot_msgs_py.errors import SpecError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "space_robot.laws"
PATHS = "module:Class or path/to/file.py:Class"
BUILT_IN = {
    "adaptive": "space_robot_control.laws.adaptive.law:Adaptive",
    "computed_torque": "space_robot_control.laws.computed_torque.law:ComputedTorque",
    "damped_hold": "space_robot_control.laws.damped_hold.law:DampedHold",
    "detumble": "space_robot_control.laws.detumble.law:Detumble",
    "lqr": "space_robot_control.laws.lqr.law:Lqr",
    "mfac": "space_robot_control.laws.mfac.law:ModelFree",
    "mpc": "space_robot_control.laws.mpc.law:LinearMpc",
    "none": "space_robot_control.laws.zero_command:ZeroCommand",
    "ntsmc": "space_robot_control.laws.ntsmc.quaternion_law:Ntsmc",
    "ntsmc_euler": "space_robot_control.laws.ntsmc.euler_law:NtsmcEuler",
    "park": "space_robot_control.laws.park.law:Park",
    "pd": "space_robot_control.laws.pd.law:ProportionalDerivative",
    "reaction_null_space": "space_robot_control.laws.reaction_null_space.law:ReactionNullSpace",
}


def law_names() -> tuple[str, ...]:
    """Return the names ``law_class`` knows: the built-in ones, then those of installed distributions, sorted."""
    return (*BUILT_IN, *sorted(_installed()))


def law_class(name: str, key: str = "controller.law", policy: LawPolicy = TYPED) -> type[Law]:
    """Return a law's class.

    Args:
        name: a built-in name, the name of an entry point in the group ``space_robot.laws``, ``module:Class``, or
            ``path/to/file.py:Class``. A built-in name wins over an entry point.
        key: what to call the name in an error.
        policy: whose code may be imported; the default takes the name for one that the user typed.

    Raises:
        SpecError: there is no such law, it cannot be imported, or it is not a ``Law``.
        CodeError: the policy does not let it be imported; nothing was.
    """
    if name not in BUILT_IN and ":" in name:
        policy.check(name, key)
    path = BUILT_IN.get(name, name)
    if ":" not in path:
        # Only here: asking every distribution for its entry points takes longer than to build a law.
        installed = _installed()
        path = installed[name].value if name in installed else name
    if ":" not in path:
        close = nearest(name, law_names())
        accepted = f"did you mean {close}?" if close else f"{', '.join(law_names())}, {PATHS}"
        raise SpecError("no such law", key=key, value=name, accepted=accepted)
    return _imported(path, key)


def make_law(
    name: str,
    robot: Robot,
    control_period: float,
    gains: Mapping[str, Any] | None = None,
    key: str = "controller",
    policy: LawPolicy = TYPED,
) -> Law:
    """Build a law from its section of an experiment file.

    Args:
        name: see ``law_class``.
        robot: the NOMINAL robot.
        control_period: [s].
        gains: the law's gains as read from a file; what is missing has its default.
        key: where the law stands in the file, for errors.
        policy: see ``law_class``.

    Raises:
        SpecError: the law, a gain or the period cannot be used.
    """
    cls = law_class(name, f"{key}.law", policy)
    return cls(robot, control_period, gains_of(cls, gains, key))


def gains_of(cls: type[Law], gains: Mapping[str, Any] | None, key: str) -> Law.Gains:
    """The gains of a law from its section of an experiment file; see ``make_law``.

    Raises:
        SpecError: the class has no model of its gains, or one of them cannot be used.
    """
    if not (isinstance(cls.Gains, type) and issubclass(cls.Gains, Strict)):
        accepted = "class Gains(space_robot.Law.Gains), nested in the law"
        raise SpecError("is no model of gains", key=f"{cls.__qualname__}.Gains", value=cls.Gains, accepted=accepted)
    return validate(cls.Gains, dict(gains or {}), f"{key}.gains.")


def _installed() -> dict[str, EntryPoint]:
    # Here, because it loads a reader of e-mail, and the built-in laws need none.
    from importlib.metadata import entry_points

    return {point.name: point for point in entry_points(group=GROUP) if point.name not in BUILT_IN}


def _imported(path: str, key: str) -> type[Law]:
    module_name, _, class_name = path.rpartition(":")
    try:
        module = _from_file(Path(module_name)) if module_name.endswith(".py") else import_module(module_name)
    except Exception as error:  # a module may fail in any way while it is imported
        raise SpecError(f"cannot import ({error})", key=key, value=path, accepted=PATHS) from error
    if "<locals>" in class_name:
        accepted = "a class at the top of a module, script or notebook cell"
        raise SpecError("is defined inside a function", key=key, value=path, accepted=accepted)
    cls = getattr(module, class_name, None)
    if cls is None:
        own = [v for v in vars(module).values() if isinstance(v, type) and v.__module__ == module.__name__]
        laws = [v.__name__ for v in own if issubclass(v, Law)]
        accepted = f"one of {', '.join(laws)}" if laws else f"a Law in {module_name}, which has none"
        raise SpecError("no such class", key=key, value=path, accepted=accepted)
    if not (isinstance(cls, type) and issubclass(cls, Law)) or isabstract(cls):
        accepted = "a subclass of space_robot.Law with compute()"
        raise SpecError("not a law", key=key, value=path, accepted=accepted)
    return cls


def _from_file(file: Path) -> ModuleType:
    if not is_file(file):
        raise ImportError(f"no Python file: {short(file)}")
    name = f"space_robot_law_{file.stem}"
    spec = spec_from_file_location(name, file)
    if spec is None or spec.loader is None:
        raise ImportError(f"no Python file: {file}")
    module = module_from_spec(spec)
    # Pydantic looks up annotations of nested models in sys.modules.
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
