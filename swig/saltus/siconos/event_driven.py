"""Event-driven simulations as scripts drive them: from event to event, in two halves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from saltus import kernel as native
from saltus.siconos.arrays import Named, NotThere
from saltus.siconos.model import NonSmoothDynamicalSystem
from saltus.siconos.simulation import (
    OneStepNSProblem,
    TimeDiscretisation,
    TimeStepping,
)

if TYPE_CHECKING:
    from saltus._core import Event
    from saltus.typing import FloatArray

SICONOS_OSNSP_ED_SMOOTH_ACC, SICONOS_OSNSP_ED_IMPACT = 0, 1
TD_EVENT, NS_EVENT = 1, 2  # the end of a step, and what is located within it

_slowest = 1e-6  # [m/s] contacts that close more slowly stay closed: bounces end


def LsodarOSI() -> native.OneStepIntegrator:
    """``EventDrivenOSI(rtol=1e-10, velocity_tolerance=1e-6)``: bounces below 1e-6 m/s have come to rest."""
    return native.EventDrivenOSI(rtol=1e-10, velocity_tolerance=_slowest)


@dataclass(frozen=True)
class ScriptEvent:
    """What an EventsManager answers with."""

    time: float
    type: int

    def getDoubleTimeOfEvent(self) -> float:
        """[s]."""
        return self.time

    def getType(self) -> int:
        """1 the end of a step, 2 an impact or another change of a contact."""
        return self.type


class EventsManager(Named):
    """The events of a simulation: that which it has come to, and the next."""

    def __init__(self, simulation: EventDriven) -> None:
        self._simulation = simulation

    def currentEvent(self) -> ScriptEvent:
        """The last that was processed, the start at first."""
        return self._simulation.current

    def nextEvent(self) -> ScriptEvent:
        """The one to be processed, after advanceToEvent(); before it the end of the step."""
        return self._simulation.next

    def hasNextEvent(self) -> bool:
        return self._simulation.hasNextEvent()

    def startingTime(self) -> float:
        """[s] of the current event."""
        return self._simulation.startingTime()

    def nextTime(self) -> float:
        """[s] of the next."""
        return self._simulation.nextTime()


class EventDriven(TimeStepping):
    """A simulation from event to event: the ends of steps, and what the integrator locates within them.

        while simulation.hasNextEvent():
            simulation.advanceToEvent()     # q, velocity, y are those before the event
            simulation.processEvents()      # and those after it; p(1), lambda_(1) its impulse

    Integrators that locate no events have the ends of steps alone.

    Parameters
    ----------
    nsds, td : model and steps
    """

    def __init__(self, nsds: NonSmoothDynamicalSystem, td: TimeDiscretisation) -> None:
        super().__init__(nsds, td)
        self._pending: list[Event] = []
        self._end: list[FloatArray] = []
        self._arrived = False
        self.current = ScriptEvent(self._nsds.t0(), TD_EVENT)

    def insertNonSmoothProblem(self, problem: OneStepNSProblem, id: int = SICONOS_OSNSP_ED_IMPACT) -> None:
        """Impacts and accelerations have one solver. Raises NotImplementedError for another level."""
        if id not in (SICONOS_OSNSP_ED_IMPACT, SICONOS_OSNSP_ED_SMOOTH_ACC):
            raise NotThere(f"SICONOS_OSNSP_ED_IMPACT = 1 and _ED_SMOOTH_ACC = 0 are there, got {id}")
        super().insertNonSmoothProblem(problem)

    def eventsManager(self) -> EventsManager:
        return EventsManager(self)

    @property
    def next(self) -> ScriptEvent:
        """See EventsManager.nextEvent()."""
        if self._arrived and self._pending:
            return ScriptEvent(self._pending[0].t, NS_EVENT)
        return ScriptEvent(super().nextTime(), TD_EVENT)

    def hasNextEvent(self) -> bool:
        """Say whether there is an event up to T."""
        return bool(self._pending) or self._arrived or super().hasNextEvent()

    def startingTime(self) -> float:
        """Of the last event [s]."""
        return self.current.time

    def nextTime(self) -> float:
        """Of the next event [s]."""
        return self.next.time

    def advanceToEvent(self) -> None:
        """Go on to the next event: the state before it.

        Raises
        ------
        SimulationError
            If it cannot be reached.
        """
        if self._arrived:
            return
        if not self._computed:
            self._take_step()
        self._arrived = True
        if self._pending:
            self._show(self._pending[0], before=True)
        else:
            self._show_end()

    def _take_step(self) -> None:
        simulation = self._simulation or self._start()
        if not isinstance(simulation, native.TimeStepping):
            raise NotThere("event-driven simulations are of mechanical systems, TimeStepping takes all")
        self._pending = []
        for _ in range(self._substeps):
            simulation.step()
            self._pending += simulation.events
        self._computed = True
        self._end = [array.copy() for array in self._arrays()]

    def processEvents(self) -> None:
        """Go through the event: the state after it. Raises RuntimeError before advanceToEvent()."""
        if not self._arrived:
            raise RuntimeError("expected advanceToEvent() before processEvents(), got none")
        self.current, self._arrived = self.next, False
        if self._pending:
            self._show(self._pending.pop(0), before=False)
            return
        self._computed = False
        self._step += 1

    computeOneStep = advanceToEvent
    nextStep = processEvents

    def _arrays(self) -> list[FloatArray]:
        systems, links = self._nsds._systems, self._nsds._links
        lives = [ds._live for ds in systems] + [interaction._live for interaction, _, _ in links]
        return [array for live in lives for array in live]

    def _show(self, event: Event, *, before: bool) -> None:
        """Every live array at an event."""
        q = v = gap = row = 0
        zero = np.zeros(len(event.v)), np.zeros(len(event.velocities))
        velocity = event.v_before if before else event.v
        rates = event.velocities_before if before else event.velocities
        impulses = (zero[0], zero[1]) if before else (event.generalised_impulse, event.impulse)
        forces = (zero[0], zero[1]) if before else (event.generalised_force, event.force)
        for ds in self._nsds._systems:
            coordinates, n = len(ds._live[0]), len(ds._live[1])
            ds._live[0][:] = event.q[q : q + coordinates]
            for array, values in zip(ds._live[1:], (velocity, impulses[0], forces[0]), strict=True):
                array[:] = values[v : v + n]
            q, v = q + coordinates, v + n
        for interaction, _, _ in self._nsds._links:
            gaps, rows = len(interaction._live[0]), len(interaction._live[1])
            interaction._live[0][:] = event.gaps[gap : gap + gaps]
            for array, values in zip(interaction._live[1:], (rates, impulses[1], forces[1]), strict=True):
                array[:] = values[row : row + rows]
            gap, row = gap + gaps, row + rows

    def _show_end(self) -> None:
        """Every live array at the end of the step, where no impulse acts."""
        for array, kept in zip(self._arrays(), self._end, strict=True):
            array[:] = kept
        for live in [ds._live for ds in self._nsds._systems] + [link[0]._live for link in self._nsds._links]:
            live[2][:] = 0.0
