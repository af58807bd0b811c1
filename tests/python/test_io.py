"""Results on disk."""

import os

import h5py
import numpy as np
import pytest
import saltus.kernel as sk
from saltus.io import read_hdf5
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
    np.testing.assert_array_equal(shape.outline, original.outline)
    assert read_hdf5(back.to_hdf5(tmp_path / "again.h5")).provenance == back.provenance


def test_units_and_provenance(trajectory, tmp_path):
    with h5py.File(trajectory.to_hdf5(tmp_path / "ball.h5")) as file:
        assert file["columns/impulse"].attrs["unit"] == "N s"
        assert file["columns/t"].attrs["unit"] == "s"
    assert trajectory.provenance.integrator == "HalfExplicitTrapezoidalOSI"
    assert trajectory.provenance.time_step == 5e-3


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
    with pytest.raises(ValueError, match="has format 99"):
        read_hdf5(tmp_path / "newer.h5")


def test_a_pose_that_is_not_one(tmp_path):
    mass = sk.LagrangianLinearTIDS([0.0], [1.0], [[1.0]])
    mass.add_shape(sk.Disc(1.0), pose=lambda q: (q[0], 0.0))
    trajectory = sk.TimeStepping(sk.NonSmoothDynamicalSystem([mass]), "ExplicitMoreauJeanOSI", 0.5).run(1.0)
    with pytest.raises(ValueError, match=r"three finite numbers \(x, y, angle\), got 2"):
        trajectory.to_hdf5(tmp_path / "x.h5")
    assert os.listdir(tmp_path) == []
    with pytest.raises(TypeError, match="shape must be a Disc, Box or Polyline, got str"):
        mass.add_shape("disc", pose=lambda q: q)
    with pytest.raises(TypeError, match="pose must be a function"):
        mass.add_shape(sk.Disc(1.0), pose=(0, 0, 0))
