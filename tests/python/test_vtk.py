"""Files for ParaView, read back by VTK."""

import sys
from xml.etree import ElementTree

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.cli.app import app
from saltus.examples.rolling_sphere import rolling_sphere
from saltus.io import ContactState, read_hdf5
from saltus.io.vtk import MOST_FRAMES
from test_models import ball
from typer.testing import CliRunner
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

RADIUS = 0.125  # [m]
SCHEME = "HalfExplicitTrapezoidalOSI"


def frames(collection):
    """[(time, polygonal data)] of a collection."""
    root = ElementTree.parse(collection).getroot()
    found = []
    for entry in root.iter("DataSet"):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(collection.parent / entry.get("file")))
        reader.Update()
        found.append((float(entry.get("timestep")), reader.GetOutput()))
    return found


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def of_points(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def of_cells(data, name):
    return vtk_to_numpy(data.GetCellData().GetArray(name))


def texts(data, name):
    array = data.GetFieldData().GetAbstractArray(name)
    return [array.GetValue(k) for k in range(array.GetNumberOfValues())]


def cells(data):
    """Numbers of the points of lines and of faces."""
    lines, faces = data.GetLines(), data.GetPolys()
    return [vtk_to_numpy(array.GetConnectivityArray()).tolist() for array in (lines, faces)]


def shown_ball(**options):
    """A ball with a shape, and the place of its contact."""
    system = ball(**options)
    system.systems[0].add_shape(sk.Disc(RADIUS), pose=lambda q: (0.0, q[0] + RADIUS, 0.0))
    system.links[0][0].show_at(lambda q: ((0.0, q[0]), (0.0, 1.0)))
    return system


def falling(until=2.0, time_step=1e-2):
    return sk.TimeStepping(shown_ball(), SCHEME, time_step).run(until)


def test_bodies_are_where_they_are(tmp_path):
    run = falling()
    bodies, _ = run.to_vtk(tmp_path, every=1)
    found = frames(bodies)
    assert [t for t, _ in found] == run.t.tolist()
    shape = run.shapes[0]
    disc = np.zeros((len(shape.points), 3))
    disc[:, :2] = shape.points
    height = run.q[:, 0] + RADIUS
    for (_, data), y in zip(found, height, strict=True):
        np.testing.assert_array_equal(points(data)[: len(disc)], disc + [0.0, y, 0.0])
    mean = np.diff(height) / np.diff(run.t)
    for (_, data), speed in zip(found, [mean[0], *mean], strict=True):
        np.testing.assert_allclose(of_points(data, "velocity")[0], [0.0, speed, 0.0], rtol=1e-12, atol=1e-12)


def test_lines_come_before_faces_and_know_their_shape(tmp_path):
    mass = sk.LagrangianLinearTIDS([0.0], [1.0], [[1.0]])
    system = sk.NonSmoothDynamicalSystem([sk.LagrangianLinearTIDS([5.0], [0.0], [[1.0]]), mass])
    mass.add_shape(sk.Box(2.0, 4.0), pose=lambda q: (q[0], 0.0, np.pi / 2))
    mass.add_shape(sk.Polyline(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))), pose=lambda q: (q[0], 0.0, 0.0))
    triangle = sk.Mesh(np.eye(3), np.array([[0, 1, 2]]))
    system.add_shape(triangle, (0.0, 0.0, 10.0, 1.0, 0.0, 0.0, 0.0))
    run = sk.TimeStepping(system, SCHEME, 0.5).run(1.0)
    (bodies,) = run.to_vtk(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bodies", "bodies.pvd"]
    _, data = frames(bodies)[-1]
    np.testing.assert_allclose(
        points(data),
        [
            *([3.0, -1.0, 0.0], [3.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]),
            *([1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]),
            *([1.0, 0.0, 10.0], [0.0, 1.0, 10.0], [0.0, 0.0, 11.0]),
        ],
        atol=1e-15,
    )
    assert cells(data) == [[0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6], [0, 1, 2, 0, 2, 3, 7, 8, 9]]
    assert texts(data, "kinds") == ["Box", "Mesh", "Polyline"]
    assert of_cells(data, "kind").tolist() == 4 * [0] + 2 * [2] + 2 * [0] + [1]
    assert of_cells(data, "shape").tolist() == 4 * [0] + 2 * [1] + 2 * [0] + [2]
    assert of_cells(data, "system").tolist() == 4 * [1] + 2 * [1] + 2 * [1] + [-1]


def test_a_body_turns_in_space(tmp_path):
    spin, height = 3.0, 2.0
    body = sk.NewtonEulerDS(
        [0, 0, height, 1, 0, 0, 0], [0.5, 0, 0, 0, 0, spin], mass=1.0, inertia=[0.1, 0.2, 0.3]
    )
    body.add_shape(sk.Box(1.0, 2.0, 3.0))
    run = sk.TimeStepping(sk.NonSmoothDynamicalSystem([body]), SCHEME, 1e-3).run(1.0)
    t, data = frames(run.to_vtk(tmp_path, every=500)[0])[1]
    assert t == 0.5
    c, s = np.cos(spin * t), np.sin(spin * t)
    for corner, placed in zip(run.shapes[0].points, points(data), strict=True):
        x, y, z = corner
        np.testing.assert_allclose(placed, [c * x - s * y + 0.5 * t, s * x + c * y, z + height], atol=1e-6)


@pytest.mark.parametrize(("scheme", "error"), [(SCHEME, 1e-5), ("MoreauJeanOSI", 2e-2)])
def test_contacts_have_their_forces_in_space(scheme, error, tmp_path):
    run = sk.TimeStepping(rolling_sphere.build(), scheme, 1e-3).run(1.0)
    _, contacts = run.to_vtk(tmp_path, every=100)
    found = frames(contacts)
    weight = rolling_sphere.MASS * rolling_sphere.GRAVITY
    slip = rolling_sphere.slip()
    for row, (t, data) in zip(range(0, 1001, 100), found, strict=True):
        assert t == run.t[row]
        np.testing.assert_allclose(points(data), [[*run.q[row, :2], 0.0]], atol=1e-6)
        assert of_points(data, "gap").tolist() == run["plane"].gap[row].tolist()
        np.testing.assert_array_equal(of_points(data, "impulse"), 0.0)
        sliding = t < rolling_sphere.rolling().t
        kind = ContactState(int(of_points(data, "state")[0]))
        assert kind == (ContactState.SLIP if sliding else ContactState.STICK)
        if row:
            force = of_points(data, "force")[0]
            assert force[2] == pytest.approx(weight, rel=1e-6)
            friction = rolling_sphere.MU * weight if sliding else 0.0
            assert np.hypot(*force[:2]) == pytest.approx(friction, abs=1e-6)
            along = friction * slip / np.linalg.norm(slip)
            np.testing.assert_allclose(force[:2], -along, atol=error * weight)
        np.testing.assert_array_equal(of_points(data, "direction0"), [[0.0, 0.0, 1.0]])
        frame = np.vstack([of_points(data, f"direction{k}")[0] for k in range(3)])
        np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-6)
    assert texts(data, "contacts") == ["plane"]
    assert texts(data, "states") == ["open", "closed", "stick", "slip", "impact", "held"]


def test_frames_are_even_and_no_impact_is_missed(tmp_path):
    run = falling(until=3.0)
    hits = run.t[run.impulsive].tolist()
    times = [t for t, _ in frames(run.to_vtk(tmp_path, every=50)[0])]
    assert times == sorted({*run.t[::50].tolist(), *hits})
    impulses = [
        of_points(data, "impulse")[0, 1] for t, data in frames(tmp_path / "contacts.pvd") if t in hits
    ]
    np.testing.assert_allclose(impulses, run["floor"].impulse[run.impulsive, 0], rtol=1e-6)
    short = falling(until=3.0, time_step=1e-3)
    by_default = [t for t, _ in frames(short.to_vtk(tmp_path)[0])]
    assert set(by_default) >= {*short.t[short.impulsive], short.t[0], short.t[-1]}
    assert MOST_FRAMES <= len(by_default) <= MOST_FRAMES + len(hits)
    assert np.diff(by_default).max() < 3.0 / MOST_FRAMES + 1.1e-3


def test_of_many_impacts_the_strongest_are_frames(tmp_path):
    run = sk.TimeStepping(shown_ball(restitution=1.0), SCHEME, 0.25).run(700.0)
    strength = run["floor"].impulse[:, 0]
    hits = np.flatnonzero(strength)
    assert len(hits) > MOST_FRAMES
    times = [t for t, _ in frames(run.to_vtk(tmp_path)[0])]
    strongest = run.t[hits[np.argsort(strength[hits], kind="stable")[-MOST_FRAMES:]]]
    assert set(strongest) <= set(times)
    assert len(times) <= 2 * MOST_FRAMES


def test_a_further_export_leaves_nothing_of_the_one_before(tmp_path):
    run = falling(until=0.2)
    run.to_vtk(tmp_path, every=1)
    (tmp_path / "bodies" / "mine.vtp").write_text("kept")
    run.to_vtk(tmp_path, every=10)
    assert sorted(path.name for path in (tmp_path / "bodies").iterdir()) == [
        "00000000.vtp",
        "00000010.vtp",
        "00000020.vtp",
        "mine.vtp",
    ]


def test_a_file_is_exported_as_the_run_was(tmp_path):
    run = falling()
    run.to_vtk(tmp_path / "memory", every=7)
    path = run.to_hdf5(tmp_path / "run.h5")
    done = CliRunner().invoke(app, ["export", str(path), "--vtk", str(tmp_path / "file"), "--every", "7"])
    assert done.exit_code == 0, done.output
    assert done.stdout.splitlines() == [str(tmp_path / f"file/{name}.pvd") for name in ("bodies", "contacts")]
    for name in ("bodies", "contacts"):
        assert (tmp_path / f"file/{name}.pvd").read_bytes() == (tmp_path / f"memory/{name}.pvd").read_bytes()
        for (_, one), (_, other) in zip(
            frames(tmp_path / f"memory/{name}.pvd"), frames(tmp_path / f"file/{name}.pvd"), strict=True
        ):
            np.testing.assert_array_equal(points(one), points(other))
    assert len(read_hdf5(path).to_vtk(tmp_path / "again")) == 2


def test_what_cannot_be_exported(tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"got neither shapes nor places .* give its systems shapes"):
        sk.TimeStepping(ball(), SCHEME, 1e-2).run(0.1).to_vtk(tmp_path / "nothing")
    run = falling(until=0.1)
    with pytest.raises(ValueError, match="every must be at least 1, got 0"):
        run.to_vtk(tmp_path / "nothing", every=0)
    assert not (tmp_path / "nothing").exists()
    (tmp_path / "file").write_text("kept")
    with pytest.raises(OSError, match=r"cannot write into '.*file': expected a writable folder"):
        run.to_vtk(tmp_path / "file")
    monkeypatch.setitem(sys.modules, "vtkmodules.vtkIOXML", None)
    with pytest.raises(ImportError, match=r"need the package vtk: pip install 'saltus\[vtk\]'"):
        run.to_vtk(tmp_path / "nothing")


def test_a_frame_that_cannot_be_written(tmp_path):
    run = falling(until=0.1)
    run.to_vtk(tmp_path)
    (tmp_path / "bodies" / "00000003.vtp").unlink()
    (tmp_path / "bodies" / "00000003.vtp").mkdir()
    with pytest.raises(OSError, match=r"cannot write '.*00000003.vtp': expected a writable file"):
        run.to_vtk(tmp_path)
    assert not (tmp_path / "bodies.pvd").exists()


@pytest.mark.parametrize(
    ("file", "message"),
    [
        ("text.h5", "expected an HDF5 file"),
        ("missing.h5", "cannot read"),
        ("run.h5", "need the package vtk: pip install 'saltus[vtk]'"),
    ],
)
def test_the_command_tells_what_is_wrong_in_a_line(file, message, tmp_path, monkeypatch):
    (tmp_path / "text.h5").write_text("not HDF5")
    falling(until=0.1).to_hdf5(tmp_path / "run.h5")
    monkeypatch.setitem(sys.modules, "vtkmodules.vtkIOXML", None)
    done = CliRunner().invoke(app, ["export", str(tmp_path / file), "--vtk", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (tmp_path / "out").exists()
