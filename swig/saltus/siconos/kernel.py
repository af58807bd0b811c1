"""The names of `siconos.kernel`, and all integrators of Saltus.

import saltus.siconos.kernel as sk
ball = sk.LagrangianLinearTIDS([1, 0, 0], [0, 0, 0], numpy.eye(3))
"""

from __future__ import annotations

from typing import Any

from saltus import kernel as native
from saltus.registry import IntegratorFactory
from saltus.siconos import numerics
from saltus.siconos.arrays import (
    DENSE,
    SPARSE,
    NotThere,
    SiconosVector,
    SimpleMatrix,
    compareRefFile,
    getMatrix,
    getVector,
)
from saltus.siconos.dynamical_system import BoundaryCondition
from saltus.siconos.event_driven import (
    NS_EVENT,
    SICONOS_OSNSP_ED_IMPACT,
    SICONOS_OSNSP_ED_SMOOTH_ACC,
    TD_EVENT,
    EventDriven,
    LsodarOSI,
)
from saltus.siconos.first_order import FirstOrderLinearDS, FirstOrderLinearTIDS, FirstOrderNonLinearDS
from saltus.siconos.first_order_relations import (
    ComplementarityConditionNSL,
    EulerMoreauOSI,
    FirstOrderLinearR,
    FirstOrderLinearTIR,
    FirstOrderNonLinearR,
    FirstOrderType1R,
    FirstOrderType2R,
    MixedComplementarityConditionNSL,
    RelayNSL,
    ZeroOrderHoldOSI,
)
from saltus.siconos.interactions import (
    EqualityConditionNSL,
    Interaction,
    LagrangianLinearTIR,
    LagrangianRheonomousR,
    LagrangianScleronomousR,
    NewtonImpactFrictionNSL,
    NewtonImpactNSL,
)
from saltus.siconos.model import NonSmoothDynamicalSystem
from saltus.siconos.newton_euler import (
    NewtonEuler1DR,
    NewtonEuler3DR,
    NewtonEulerDS,
    changeFrameAbsToBody,
    changeFrameBodyToAbs,
    quaternionFromRotationVector,
    rotationVectorFromConfiguration,
    rotationVectorFromQuaternion,
)
from saltus.siconos.simulation import (
    SICONOS_OSNSP_TS_VELOCITY,
    FrictionContact,
    OneStepNSProblem,
    TimeDiscretisation,
    TimeStepping,
)
from saltus.siconos.systems import (
    LagrangianDS,
    LagrangianLinearDiagonalDS,
    LagrangianLinearTIDS,
)

__all__ = [
    "DENSE",
    "NS_EVENT",
    "SICONOS_OSNSP_ED_IMPACT",
    "SICONOS_OSNSP_ED_SMOOTH_ACC",
    "SICONOS_OSNSP_TS_VELOCITY",
    "SPARSE",
    "TD_EVENT",
    "BoundaryCondition",
    "EventDriven",
    "ComplementarityConditionNSL",
    "EqualityConditionNSL",
    "EulerMoreauOSI",
    "FirstOrderLinearDS",
    "FirstOrderLinearR",
    "FirstOrderLinearTIDS",
    "FirstOrderLinearTIR",
    "FirstOrderNonLinearDS",
    "FirstOrderNonLinearR",
    "FirstOrderType1R",
    "FirstOrderType2R",
    "FrictionContact",
    "Interaction",
    "LagrangianDS",
    "LagrangianLinearDiagonalDS",
    "LagrangianLinearTIDS",
    "LagrangianLinearTIR",
    "LagrangianRheonomousR",
    "LagrangianScleronomousR",
    "LsodarOSI",
    "NewtonEuler1DR",
    "NewtonEuler3DR",
    "NewtonEulerDS",
    "MixedComplementarityConditionNSL",
    "NewtonImpactFrictionNSL",
    "NewtonImpactNSL",
    "NonSmoothDynamicalSystem",
    "RelayNSL",
    "SiconosVector",
    "SimpleMatrix",
    "TimeDiscretisation",
    "TimeStepping",
    "ZeroOrderHoldOSI",
    "changeFrameAbsToBody",
    "changeFrameBodyToAbs",
    "compareRefFile",
    "getMatrix",
    "getVector",
    "quaternionFromRotationVector",
    "rotationVectorFromConfiguration",
    "rotationVectorFromQuaternion",
]

#: What is merely spelled otherwise: Siconos's name, ours
ALIASES: dict[str, Any] = {
    "LCP": OneStepNSProblem,
    "MLCP": OneStepNSProblem,
    "Equality": OneStepNSProblem,
    "GenericMechanical": OneStepNSProblem,
    "Relay": OneStepNSProblem,
    "AVI": OneStepNSProblem,
    "D1MinusLinearOSI": native.DMinusAccelerationOSI,
    "TimeSteppingD1Minus": TimeStepping,
    "FixedBC": BoundaryCondition,
    "NewtonEulerFrom1DLocalFrameR": NewtonEuler1DR,
    "NewtonEulerFrom3DLocalFrameR": NewtonEuler3DR,
}

#: What is not there: it can be imported, and says so where it is used
NOT_THERE = {
    **dict.fromkeys(
        ("NewMarkAlphaOSI", "Hem5OSI"),
        "not there; LsodarOSI and HalfExplicitRungeKuttaOSI(tableau='HEM5') are",
    ),
    **dict.fromkeys(
        (
            "MoreauJeanGOSI",
            "MoreauJeanDirectProjectionOSI",
            "MoreauJeanCombinedProjectionOSI",
            "MoreauJeanBilbaoOSI",
            "SchatzmanPaoliOSI",
            "TimeSteppingDirectProjection",
            "TimeSteppingCombinedProjection",
        ),
        "not there; MoreauJeanOSI and HalfExplicitTrapezoidalOSI(stabilization='position') are",
    ),
    "NewtonEulerR": "not there; NewtonEuler1DR and NewtonEuler3DR are",
    "LagrangianCompliantLinearTIR": "compliant relations are not there, LagrangianLinearTIR is",
    "LagrangianCompliantR": "compliant relations are not there, LagrangianScleronomousR is",
    "HarmonicBC": "not there, EqualityConditionNSL with a LagrangianRheonomousR is",
}


_INTEGRATORS = [entry["name"] for entry in native.integrators()]
_IDS = [name for name in numerics.__all__ if name.startswith("SICONOS_")]
__all__ += [*ALIASES, *NOT_THERE, *_INTEGRATORS, *_IDS]  # what `import *` gives


def __getattr__(name: str) -> Any:
    if name in ALIASES:
        return ALIASES[name]
    if name in NOT_THERE:
        return _refusing(name, NOT_THERE[name])
    if name.startswith("SICONOS_"):
        return getattr(numerics, name)
    if name in dir(native):  # the integrators of the registry
        found = getattr(native, name)
        if isinstance(found, IntegratorFactory):
            return found
    raise AttributeError(f"saltus.siconos.kernel has no '{name}', it has {', '.join(__dir__())}")


def __dir__() -> list[str]:
    return sorted(set(__all__) - set(NOT_THERE))


def _refusing(name: str, why: str) -> type:
    """A class that a script can import and derive from, but not make."""

    def refuse(self: object, *_: object, **__: object) -> None:
        raise NotThere(f"{name}: {why}")

    return type(name, (), {"__init__": refuse, "__doc__": why})
