"""Torque models of robot arms: identify, train, predict, and explain what a simulator gets wrong.

The numbers are those of the programs `train`, `eval`, `diagnose` and `replay`, to the last bit.

    import residyn

    robot = residyn.Robot("arm.urdf")
    report = residyn.diagnose(robot, data="monday.csv", heldout="tuesday.csv")
    print(report)
    report.patch("arm_corrected.urdf")
"""

from importlib.metadata import PackageNotFoundError, version

from ._residyn import InputError, Robot
from .accumulator import Accumulator, Identified, Parameter
from .checked import Check, check
from .compensated import Compensated
from .diagnosis import Cause, Place, Push, Report, Step, diagnose
from .learned import Learned
from .model import Model, Prediction, identify, train
from .motion import ReplayReport, ReplayStep, replay
from .recording import Recording

try:
    __version__ = version("residyn")
except PackageNotFoundError:
    __version__ = "unknown"

__all__ = [
    "Accumulator",
    "Cause",
    "Check",
    "Compensated",
    "Identified",
    "InputError",
    "Learned",
    "Model",
    "Parameter",
    "Place",
    "Prediction",
    "Push",
    "Recording",
    "ReplayReport",
    "ReplayStep",
    "Report",
    "Robot",
    "Step",
    "check",
    "diagnose",
    "identify",
    "replay",
    "train",
]
