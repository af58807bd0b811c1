"""A run as numpy arrays."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from saltus import notebook
from saltus.io.contact_states import ContactState, Reactions, contact_states
from saltus.io.csv import write_csv
from saltus.io.hdf5 import read_run, write_run
from saltus.io.records import (
    CONTACT_COLUMNS,
    ContactRecord,
    Layout,
    Loaded,
    PlaceRecord,
    Provenance,
    Rows,
    Scene,
    ShapeRecord,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from saltus.scene import Appearance
    from saltus.typing import AxesArray, BoolArray, FloatArray, IntArray, StateArray


BLOCK = 65536  #: rows that are summed at a time
NOTHING = Scene()  #: that is seen


class Trajectory:
    """A run: row 0 is the initial state with zero reactions, row k the step that ends at t[k].

    ``trajectory["floor"]`` is the record of the contact of that name. While a simulation goes on, its
    trajectory grows with it.
    """

    def __init__(
        self,
        source: Rows,
        layout: Layout,
        provenance: Provenance,
        look: Appearance | Scene = NOTHING,
    ) -> None:
        self._source = source
        self._columns: Mapping[str, Any] = {}
        self._rows = -1  # of these columns
        self._run: Reactions | None = None  # of these columns
        self._states: dict[str, StateArray] = {}  # likewise
        self._look = look
        self.layout = layout
        self.provenance = provenance

    def columns(self) -> Mapping[str, Any]:
        """All columns, name: array with one entry or row for each row of the run."""
        if self._rows != self._source.rows:
            self._columns, self._rows = self._source.columns(), self._source.rows
            self._run = None
            self._states = {}
        return self._columns

    def loaded(self) -> Trajectory:
        """The same run with all columns in memory, also if it is being written to a file."""
        columns = dict(self.columns())
        return Trajectory(Loaded(len(columns["t"]), columns), self.layout, self.provenance, self._look)

    def __len__(self) -> int:
        return self._source.rows

    def __getitem__(self, name: str) -> ContactRecord:
        try:
            slot = self.layout.contacts[name]
        except KeyError:
            known = ", ".join(self.layout.contacts) or "none"
            raise KeyError(f"no contact named {name!r}, there are {known}") from None
        columns = self.columns()
        rows = slice(slot.row, slot.row + slot.rows)
        gaps = slice(slot.gap, slot.gap + slot.gaps)
        parts = {key: columns[key][:, gaps if key == "gap" else rows] for key in CONTACT_COLUMNS}
        return ContactRecord(name, **parts, law=slot.law, find_states=lambda: self._states_of(name))

    @property
    def contacts(self) -> tuple[str, ...]:
        """Names of the contacts."""
        return tuple(self.layout.contacts)

    @property
    def t(self) -> FloatArray:
        """Times (rows,) [s]."""
        return self._float("t")

    @property
    def step(self) -> IntArray:
        """Number of the step of each row (rows,)."""
        return self._int("step")

    @property
    def q(self) -> FloatArray:
        """Positions (rows, n) of all systems, one after the other."""
        return self._float("q")

    @property
    def v(self) -> FloatArray:
        """Velocities v⁺ (rows, n)."""
        return self._float("v")

    @property
    def impulsive(self) -> BoolArray:
        """Was the impact law applied in the step, under Moreau-Jean: did an impulse act? (rows,)."""
        column: BoolArray = self.columns()["impulsive"]
        return column

    @property
    def closed(self) -> IntArray:
        """Number of closed contacts at the end of the step (rows,)."""
        return self._int("closed")

    @property
    def residual(self) -> FloatArray:
        """Largest certificate of the step's contact problems (rows,) [m/s]."""
        return self._float("residual")

    @property
    def penetration(self) -> FloatArray:
        """Largest -g of the unilateral contacts, or 0 (rows,) [m]."""
        return self._float("penetration")

    @property
    def kinetic_energy(self) -> FloatArray:
        """½ vᵀMv (rows,) [J]."""
        return self._float("kinetic_energy")

    @property
    def potential_energy(self) -> FloatArray:
        """V (rows,) [J], NaN if a system does not define it."""
        return self._float("potential_energy")

    @property
    def energy(self) -> FloatArray:
        """Kinetic and potential energy together (rows,) [J]."""
        return self.kinetic_energy + self.potential_energy

    @property
    def work_forces(self) -> FloatArray:
        """Work of the applied forces in the step, of h and of the change of M (rows,) [J]."""
        return self._float("work_forces")

    @property
    def work_lambda(self) -> FloatArray:
        """Work of λ⁺ and λ⁻ in the step (rows,) [J]."""
        return self._float("work_lambda")

    @property
    def work_impulse(self) -> FloatArray:
        """Work of Λ in the step (rows,) [J], exactly the jump of the kinetic energy."""
        return self._float("work_impulse")

    @property
    def accepted_steps(self) -> IntArray:
        """Steps that the scheme took within each step of Δt (rows,); 0 if it chooses none of its own."""
        return self._int("accepted_steps")

    @property
    def rejected_steps(self) -> IntArray:
        """Those it took again because their error was too large (rows,)."""
        return self._int("rejected_steps")

    @property
    def event_steps(self) -> IntArray:
        """Those it ended at an event that was located, such as a closing contact (rows,)."""
        return self._int("event_steps")

    @property
    def captures(self) -> IntArray:
        """Contacts closed plastically because their bounces had become too short (rows,)."""
        return self._int("captures")

    @property
    def scene(self) -> Scene:
        """What is seen in every row: shapes with their poses, contacts with their places."""
        return self._look if isinstance(self._look, Scene) else self._look.scene(self.t, self.q)

    def scene_in(self, rows: IntArray) -> Scene:
        """What is seen in these rows (k,) alone."""
        if isinstance(self._look, Scene):
            return self._look.in_rows(rows)
        return self._look.scene(self.t[rows], self.q[rows])

    @property
    def shapes(self) -> tuple[ShapeRecord, ...]:
        """The shapes of the systems and around them, with their poses in every row."""
        return self.scene.shapes

    @property
    def places(self) -> tuple[PlaceRecord, ...]:
        """Where the contacts are that know it, in every row."""
        return self.scene.places

    @property
    def told_apart(self) -> bool:
        """Are there forces λ besides impulses Λ? Under Moreau-Jean all that acts is Λ, also at rest."""
        return self._reactions().told_apart

    @property
    def impacts(self) -> BoolArray:
        """Was there an impact in the step? Under Moreau-Jean: of a contact that had been open (rows,)."""
        if self.told_apart:
            return self.impulsive
        hit = np.zeros(len(self), dtype=np.bool_)
        for name in self.contacts:
            hit |= self._states_of(name) == ContactState.IMPACT
        return hit

    def busiest_contacts(self, most: int) -> list[str]:
        """Names of all contacts; of more than `most` those that pressed most, in their order."""
        names = list(self.contacts)
        if len(names) <= most:
            return names
        force, impulse = self.columns()["force"], self.columns()["impulse"]
        pressed = np.zeros(force.shape[1])  # [N s]
        for start in range(0, len(force), BLOCK):  # without a copy of all
            rows = slice(start, start + BLOCK)
            pressed += self.provenance.time_step * np.abs(force[rows]).sum(axis=0)
            pressed += np.abs(impulse[rows]).sum(axis=0)
        normal = [pressed[slot.row : slot.row + slot.gaps].sum() for slot in self.layout.contacts.values()]
        busiest = sorted(range(len(names)), key=lambda k: -normal[k])[:most]  # stable: the first of equals
        return [names[k] for k in sorted(busiest)]

    def strongest_impacts(self, most: int) -> IntArray:
        """Rows with an impact; of more than `most` those with the largest impulses."""
        hits = np.flatnonzero(self.impacts)
        if len(hits) <= most:
            return hits
        strength = np.abs(self.columns()["impulse"][hits]).sum(axis=1)
        return hits[np.argsort(strength, kind="stable")[-most:]]

    def reactions(self, name: str) -> tuple[FloatArray, FloatArray]:
        """Forces [N] and impulses [N s] of a contact, each (rows of the run, rows of the contact).

        They are its `force` and `impulse`. Under Moreau-Jean, where all that acts is Λ, Λ/Δt is the force in
        steps without an impact of the contact, and Λ the impulse of those with one.

        Raises
        ------
        KeyError
            If there is no contact of that name.
        """
        contact = self[name]
        if self.told_apart:
            return contact.force, contact.impulse
        hit = (contact.states == ContactState.IMPACT)[:, None]
        mean = contact.impulse / self.provenance.time_step
        return np.where(hit, 0.0, mean), np.where(hit, contact.impulse, 0.0)

    def plot(
        self,
        axes: Axes | Sequence[Axes] | AxesArray | None = None,
        contacts: Sequence[str] | None = None,
    ) -> AxesArray:
        """Draw positions, gaps, normal forces and impulses, and energy over time; grey lines mark impacts.

        Under Moreau-Jean, whose reactions are all impulses, Λ/Δt is drawn as the force of steps without an
        impact of the contact.

        Parameters
        ----------
        axes : one for each of the five panels, or of the two (positions, energy) of a run without contacts;
            without it a figure is made
        contacts : names of those to draw; without it all, or of more than 12 those that pressed most

        Returns
        -------
        (panels,) of Axes
            Those drawn into, ``axes[0].figure`` is the figure.

        Raises
        ------
        ValueError
            If there are more or fewer axes than panels.
        KeyError
            If there is no contact of a name.
        """
        from saltus.plot import plot_trajectory

        return plot_trajectory(self, axes, contacts)

    def plot_contacts(
        self,
        axes: Axes | Sequence[Axes] | AxesArray | None = None,
        contacts: Sequence[str] | None = None,
    ) -> AxesArray:
        """Draw gaps g, γ, λ and Λ of contacts, and a band of their states, see `ContactState`, over time.

        Panels are gaps, normal velocities, forces and impulses, states; and if a contact has tangential
        rows, sliding velocities, friction forces, of a few contacts with the cone |λ_T| ≤ μ λ_N, and
        tangential impulses. These are signed in the plane, in space they are lengths.

        Parameters, result and errors are those of `plot`, with five or eight panels; ValueError also if there
        is no contact.
        """
        from saltus.plot import plot_contacts

        return plot_contacts(self, axes, contacts)

    def plot_energy(self, axes: Axes | Sequence[Axes] | AxesArray | None = None) -> AxesArray:
        """Draw energy, the work that changes it, and what their balance leaves over.

        Panels are T, V and T + V; the sums of the work of h, λ and Λ beside T − T(0); and T − T(0) less these
        sums, which is zero but for the errors of the scheme's quadratures. What is lost at impacts is the
        work of Λ, what friction takes that of λ; under Moreau-Jean both are that of Λ.

        Result and errors are those of `plot`, with three panels.
        """
        from saltus.plot import plot_energy

        return plot_energy(self, axes)

    def report(
        self,
        path: str | os.PathLike[str],
        *,
        title: str | None = None,
        caption: str | None = None,
    ) -> Path:
        """Write a page for the browser: animation, plots with zoom, and what each contact does.

        One HTML file that needs no network. Of a long run it has some thousand rows: impacts, what is before
        them, the extremes of each plot, and others evenly. An existing file is replaced as a whole.

        Parameters
        ----------
        path : of the page
        title : its heading; the integrator's name if it is left out
        caption : what there is to see, a sentence or two above the animation

        Raises
        ------
        ValueError
            If the run has no rows, or times that are not finite.
        OSError
            If the file cannot be written; what was there is untouched.
        """
        from saltus.report import write_report

        return write_report(self, path, title, caption)

    def to_hdf5(self, path: str | os.PathLike[str]) -> Path:
        """Write all columns with units, what is seen, and provenance; an existing run is replaced as a whole.

        Raises
        ------
        OSError
            If the file cannot be written, FileExistsError if there is another file than a run; what was
            there is untouched.
        """
        return write_run(path, self._source, self.layout, self.provenance, self.scene)

    def to_vtk(self, folder: str | os.PathLike[str], every: int | None = None) -> list[Path]:
        """Write shapes and contacts for ParaView: a file of VTK for each frame, and collections with times.

        ``bodies.pvd`` has lines and faces of all shapes where they are. Data of points: velocity (3,), the
        mean since the row before [m/s]; of lines and faces: system, -1 around the systems, shape, and kind,
        a number of ``kinds``.

        ``contacts.pvd`` has the contacts whose place is known as points. Their data: contact, a number of
        ``contacts``; gap [m], of an equality with several rows the first; state, a number of ``states``;
        force [N] and impulse [N s] (3,) on the contact's first system, see `reactions`; direction0,
        direction1, direction2 (3,), along which its rows push, the normal first.

        Parameters
        ----------
        folder : it is made if it is not there; frames of an earlier export into it are removed
        every : every n-th row is a frame, and all with an impact; by default 300 rows evenly, and those with
            an impact, of more than 300 those with the largest impulses

        Returns
        -------
        list of Path
            The collections, which ParaView opens.

        Raises
        ------
        ImportError
            If the package vtk is missing.
        ValueError
            If the run has no rows, or neither shapes nor places of contacts, or every is less than 1.
        OSError
            If a file cannot be written.
        """
        from saltus.io.vtk import write_vtk

        return write_vtk(self, folder, every)

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write all columns as text (RFC 4180), an existing file is replaced as a whole.

        The first line has names and units, ``t [s],step [1],q0 [m or rad],...,floor.impulse0 [N s],...``;
        a contact's normal row is 0. Numbers read back are the same to the last bit.

        Raises
        ------
        OSError
            If the file cannot be written; what was there is untouched.
        """
        return write_csv(path, self._source, self.layout)

    def __repr__(self) -> str:
        count = len(self)
        span = f"t = {self.t[0]:g} ... {self.t[-1]:g} s" if count else "empty"
        return f"<Trajectory {self.provenance.integrator}: {count} rows, {span}>"

    def _repr_html_(self) -> str:
        return notebook.run(self)

    def _reactions(self) -> Reactions:
        columns = self.columns()
        if self._run is None:
            self._run = Reactions.of(columns, self.provenance.forces_at_rest)
        return self._run

    def _states_of(self, name: str) -> StateArray:
        columns = self.columns()
        if name not in self._states:
            self._states[name] = contact_states(columns, self.layout.contacts[name], self._reactions())
            self._states[name].flags.writeable = False
        return self._states[name]

    def _int(self, name: str) -> IntArray:
        column: IntArray = self.columns()[name]
        return column

    def _float(self, name: str) -> FloatArray:
        column: FloatArray = self.columns()[name]
        return column


def read_hdf5(path: str | os.PathLike[str]) -> Trajectory:
    """Read a run from a file, also one that is still being written or whose writer was killed.

    Nothing in the file is executed.

    Raises
    ------
    OSError
        If the file cannot be read or is not an HDF5 file.
    ValueError
        If it holds something else than a run of Saltus, or one of another format.
    """
    return Trajectory(*read_run(path))
