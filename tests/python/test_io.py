"""Results on disk."""

import csv
import os
from datetime import datetime, timezone

import h5py
import numpy as np
import pytest
import saltus
import saltus.kernel as sk
from saltus.examples.ball_in_box import ball_in_box
from saltus.examples.slider_crank import slider_crank
from saltus.io import read_hdf5
from saltus.io.records import CONTACT_COLUMNS, UNITS
from test_models import ball


@pytest.fixture
def trajectory():
    system = ball()
    system.systems[0].add_shape(sk.Box(0.2, 0.1), pose=lambda q: (0.0, q[0], 0.0))
    return sk.TimeStepping(system, sk.HalfExplicitTrapezoidalOSI(), time_step=5e-3).run(until=2.0)


def test_round_trip(trajectory, tmp_path):
    path = trajectory.to_hdf5(tmp_path / "ball.h5")
    back = read_hdf5(path)
    assert set(back.columns()) == set(trajectory.columns())
    for name, values in trajectory.columns().items():
        np.testing.assert_array_equal(back.columns()[name], values)
        assert back.columns()[name].dtype == values.dtype
    assert back.contacts == ("floor",)
    np.testing.assert_array_equal(back["floor"].impulse, trajectory["floor"].impulse)
    assert back.provenance == trajectory.provenance
    (shape,), (original,) = back.shapes, trajectory.shapes
    assert shape.kind == "Box"
    np.testing.assert_array_equal(shape.poses, original.poses)
    np.testing.assert_array_equal(shape.points, original.points)
    np.testing.assert_array_equal(shape.lines, original.lines)
    np.testing.assert_array_equal(shape.faces, original.faces)
    assert read_hdf5(back.to_hdf5(tmp_path / "again.h5")).provenance == back.provenance


def test_every_dataset_has_its_unit(trajectory, tmp_path):
    with h5py.File(trajectory.to_hdf5(tmp_path / "ball.h5")) as file:
        units = {name: data.attrs["unit"] for name, data in file["columns"].items()}
        assert file["shapes/000000/poses"].attrs["unit"] == "m, m, rad"
    assert units["impulse"] == "N s"
    assert units["t"] == "s"
    assert units["step"] == "1"
    assert set(units) == set(trajectory.columns())


def test_provenance_says_how_the_run_came_about(tmp_path):
    ds = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]])
    given = {"stiffness": np.float64(3.0), "name": "spring", "sizes": (1, 2), "nested": {"flag": True}}
    system = sk.NonSmoothDynamicalSystem([ds], parameters=given)
    start = datetime.now(timezone.utc)
    simulation = sk.TimeStepping(
        system, sk.MoreauJeanOSI(theta=0.75), 1e-2, solver="lemke", record_every=np.int64(3)
    )
    back = read_hdf5(simulation.run(0.1).to_hdf5(tmp_path / "run.h5")).provenance
    assert back == simulation.trajectory.provenance
    assert (back.integrator, back.options) == ("MoreauJeanOSI", {"theta": 0.75, "gamma": 0.5})
    assert (back.time_step, back.solver, back.record_every) == (1e-2, "lemke", 3)
    assert back.parameters == {"stiffness": 3.0, "name": "spring", "sizes": [1, 2], "nested": {"flag": True}}
    assert back.version == saltus.__version__
    assert start <= datetime.fromisoformat(back.created) <= datetime.now(timezone.utc)


@pytest.mark.parametrize("entry", sk.integrators(), ids=lambda entry: entry["name"])
def test_options_that_are_not_given_are_known_too(entry):
    standard = {name: about["default"] for name, about in entry["options"].items()}
    assert getattr(sk, entry["name"])().options == standard
    simulation = sk.TimeStepping(ball(), entry["name"], 1e-2)
    assert simulation.trajectory.provenance.options == standard


def test_examples_keep_their_parameters():
    crank = sk.TimeStepping(slider_crank.build("frictionless"), "ExplicitMoreauJeanOSI", 1e-4)
    assert crank.trajectory.provenance.parameters["l1"] == 0.153
    assert crank.trajectory.provenance.parameters["guidance"] == "frictionless"
    box = ball_in_box.build("down").parameters
    assert (box["restitution"], box["direction of gravity"]) == (0.3, "down")


@pytest.mark.parametrize("parameters", [{"f": abs}, {"array": np.eye(2)}, [1, 2], {1j: 0}])
def test_parameters_that_a_file_cannot_hold(parameters):
    ds = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]])
    with pytest.raises(ValueError, match="parameters must be"):
        sk.NonSmoothDynamicalSystem([ds], parameters=parameters)


def fields_of(trajectory):
    """Every column of the table as the arrays have it, by title."""
    fields = {}
    for name, unit in UNITS.items():
        values = trajectory.columns()[name]
        if values.ndim == 1:
            fields[f"{name} [{unit}]"] = values
        elif name in ("q", "v"):
            fields |= {f"{name}{k} [{unit}]": values[:, k] for k in range(values.shape[1])}
    for contact in trajectory.contacts:
        for name in CONTACT_COLUMNS:
            values = getattr(trajectory[contact], name)
            fields |= {f"{contact}.{name}{k} [{UNITS[name]}]": values[:, k] for k in range(values.shape[1])}
    return fields


@pytest.mark.parametrize("source", ["memory", "file", "stream"])
def test_csv_reads_back_to_the_same_bits(source, tmp_path):
    streamed = tmp_path / "run.h5" if source == "stream" else None
    trajectory = sk.TimeStepping(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-5, file=streamed).run(
        0.1
    )
    run = read_hdf5(trajectory.to_hdf5(tmp_path / "copy.h5")) if source == "file" else trajectory
    path = run.to_csv(tmp_path / "run.csv")
    with open(path, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header[:3] == ["t [s]", "step [1]", "q0 [m or rad]"]
    table = np.array(rows, dtype=float)
    expected = fields_of(trajectory)
    assert set(header) == set(expected)
    assert table.shape == (10001, len(expected))
    for title, values in zip(header, table.T, strict=True):
        np.testing.assert_array_equal(values, expected[title], err_msg=title)


def test_csv_follows_rfc_4180(tmp_path):
    mass = sk.LagrangianLinearTIDS([1.0], [0.0], [[1.0]], external_force=[-9.81])
    system = sk.NonSmoothDynamicalSystem([mass])
    floor = sk.LagrangianLinearTIR([[1.0]])
    system.link(sk.Interaction(floor, sk.NewtonImpactNSL(0.5), name='floor, "rough"\n'), mass)
    path = sk.TimeStepping(system, "MoreauJeanOSI", 0.5).run(1.0).to_csv(tmp_path / "x.csv")
    text = path.read_bytes().decode()
    assert '"floor, ""rough""\n.gap0 [m]"' in text
    assert text.endswith("\r\n")
    with open(path, newline="") as file:
        header, *rows = csv.reader(file)
    assert 'floor, "rough"\n.impulse0 [N s]' in header
    assert [len(row) for row in rows] == 3 * [len(header)]


def test_csv_that_cannot_be_written(trajectory, tmp_path):
    with pytest.raises(OSError, match=r"cannot write '.*': expected a writable file in an existing folder"):
        trajectory.to_csv(tmp_path / "no" / "run.csv")


@pytest.mark.parametrize("name", ["no/such/folder/ball.h5", "file.txt/ball.h5", "."])
def test_unwritable_targets_are_named(trajectory, tmp_path, name):
    (tmp_path / "file.txt").write_text("kept")
    with pytest.raises(OSError, match=r"cannot write '.*': expected a writable file in an existing folder"):
        trajectory.to_hdf5(tmp_path / name)
    assert sorted(os.listdir(tmp_path)) == ["file.txt"]


def test_a_failed_write_keeps_the_old_file_and_leaves_no_rest(trajectory, tmp_path, monkeypatch):
    path = trajectory.to_hdf5(tmp_path / "ball.h5")
    before = path.read_bytes()

    def full(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(h5py.Group, "create_dataset", full)
    with pytest.raises(OSError, match="No space left on device"):
        trajectory.to_hdf5(path)
    assert path.read_bytes() == before
    assert os.listdir(tmp_path) == ["ball.h5"]


def test_reading_something_else(tmp_path):
    with pytest.raises(OSError, match="cannot read .*missing.h5"):
        read_hdf5(tmp_path / "missing.h5")
    (tmp_path / "text.h5").write_text("not HDF5")
    with pytest.raises(OSError, match="expected an HDF5 file"):
        read_hdf5(tmp_path / "text.h5")
    with h5py.File(tmp_path / "other.h5", "w"):
        pass
    with pytest.raises(ValueError, match="must be a run of Saltus"):
        read_hdf5(tmp_path / "other.h5")
    with h5py.File(tmp_path / "newer.h5", "w") as file:
        file.attrs["saltus_format"] = 99
    with pytest.raises(ValueError, match="has format 99, this version reads 4"):
        read_hdf5(tmp_path / "newer.h5")


def test_a_pose_that_is_not_one(tmp_path):
    mass = sk.LagrangianLinearTIDS([0.0], [1.0], [[1.0]])
    mass.add_shape(sk.Disc(1.0), pose=lambda q: (q[0], 0.0))
    trajectory = sk.TimeStepping(sk.NonSmoothDynamicalSystem([mass]), "ExplicitMoreauJeanOSI", 0.5).run(1.0)
    with pytest.raises(ValueError, match=r"three finite numbers \(x, y, angle\), or seven in space, got 2"):
        trajectory.to_hdf5(tmp_path / "x.h5")
    assert os.listdir(tmp_path) == []
    with pytest.raises(
        TypeError, match="shape must be a Disc, Box, Polyline, Sphere, Cylinder or Mesh, got str"
    ):
        mass.add_shape("disc", pose=lambda q: q)
    with pytest.raises(TypeError, match="pose must be a function"):
        mass.add_shape(sk.Disc(1.0), pose=(0, 0, 0))
