"""Shapes, poses and places: what pictures show is where it is in the model."""

from math import cos, sin, sqrt

import numpy as np
import pytest
import saltus.kernel as sk
from saltus.examples.slider_crank import slider_crank
from saltus.io import read_hdf5
from saltus.shapes import Geometry

TURN = [sqrt(0.5), sqrt(0.5), 0.0, 0.0]  # a quarter about x: y becomes z
TETRAHEDRON = sk.Mesh(
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
)


def volume(geometry: Geometry) -> float:
    """By the divergence theorem: right only if faces close and are all seen counterclockwise from outside."""
    a, b, c = (geometry.points[geometry.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize(
    ("shape", "exact", "within"),
    [
        (sk.Box(1.0, 2.0, 3.0), 6.0, 1e-12),
        (TETRAHEDRON, 1 / 6, 1e-12),
        (sk.Sphere(2.0), 4 / 3 * np.pi * 8, 0.05),
        (sk.Cylinder(2.0, 3.0), np.pi * 4 * 3, 0.01),
        (sk.Cylinder(2.0, 3.0, radius_on_top=1.0), np.pi * 7, 0.01),
        (sk.Cylinder(2.0, 3.0, radius_on_top=0.0), np.pi * 4, 0.01),
    ],
)
def test_solids_are_closed_and_seen_from_outside(shape, exact, within):
    geometry = shape.geometry()
    assert volume(geometry) == pytest.approx(exact, rel=within)
    edges = np.sort(np.vstack([geometry.faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    counts = np.unique(edges, axis=0, return_counts=True)[1]
    assert (counts == 2).all()


def test_plane_shapes_have_their_area():
    for shape, exact in ((sk.Disc(2.0), 4 * np.pi), (sk.Box(2.0, 3.0), 6.0)):
        geometry = shape.geometry()
        a, b, c = (geometry.points[geometry.faces[:, k]] for k in range(3))
        area = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum() / 2
        assert area == pytest.approx(exact, rel=0.01)


def body(q0=(0, 0, 2, *TURN), v0=(1, 0, 0, 0, 0, 0)):
    return sk.NewtonEulerDS(list(q0), list(v0), 1.0, [1.0, 1.0, 1.0], force=[0.0, 0.0, -9.81])


def test_a_rigid_body_carries_its_shape_and_a_file_keeps_it(tmp_path):
    ball = body()
    ball.add_shape(sk.Box(1.0, 2.0, 4.0))
    system = sk.NonSmoothDynamicalSystem([ball])
    system.add_shape(sk.Box(5.0, 5.0))
    system.add_shape(sk.Polyline(((0, 0, 0), (0, 0, 1))), pose=lambda t: (t, 0.0, 0.0))
    floor = sk.SpherePlane(3, radius=0.0, point=[0, 0, 0], normal=[0, 0, 1], centre=[0, 0, 2])
    system.link(sk.Interaction(floor, sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.5, 3), name="floor"), ball)
    run = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 0.1).run(0.5)
    box, ground, pole = run.shapes
    np.testing.assert_array_equal(box.poses, run.q)
    corner = box.in_space(0)[6]  # (0.5, 1, 2) in its frame
    np.testing.assert_allclose(corner, [0.5, -2.0, 2.0 + 1.0], atol=1e-15)
    assert (ground.system, ground.poses.shape) == (-1, (6, 3))
    np.testing.assert_allclose(pole.in_space(5), [[0.5, 0, 0], [0.5, 0, 1]])
    (place,) = run.places
    np.testing.assert_allclose(place.point[0], [0.0, -2.0, 2.0], atol=1e-6)
    np.testing.assert_allclose(place.directions[0] @ place.directions[0].T, np.eye(3), atol=1e-6)
    again = read_hdf5(run.to_hdf5(tmp_path / "body.h5"))
    for shape, original in zip(again.shapes, run.shapes, strict=True):
        for name in ("points", "lines", "faces", "poses", "system", "kind"):
            np.testing.assert_array_equal(getattr(shape, name), getattr(original, name))
    np.testing.assert_array_equal(again.places[0].point, place.point)
    np.testing.assert_array_equal(again.places[0].directions, place.directions)
    assert again.places[0].contact == "floor"


def test_directions_of_two_discs():
    rng = np.random.default_rng(7)
    q0 = rng.normal(size=6).tolist()
    a = sk.LagrangianLinearTIDS(q0[:3], [0, 0, 0], np.eye(3))
    b = sk.LagrangianLinearTIDS(q0[3:], [0, 0, 0], np.eye(3))
    system = sk.NonSmoothDynamicalSystem([a, b])
    pair = sk.SphereSphere(2, radius1=0.1, radius2=0.2)
    system.link(sk.Interaction(pair, sk.NewtonImpactFrictionNSL(0.0, 0.0, 0.5, 2), name="pair"), a, b)
    (place,) = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-3).trajectory.places
    d = np.array(q0[:2]) - np.array(q0[3:5])
    n = d / np.linalg.norm(d)
    np.testing.assert_allclose(place.directions[0, 0, :2], n, atol=1e-6)
    np.testing.assert_allclose(place.directions[0, 1, :2], [n[1], -n[0]], atol=1e-6)
    np.testing.assert_allclose(place.point[0, :2], np.array(q0[:2]) - 0.1 * n, atol=1e-6)


def test_joints_know_their_place():
    top = body(q0=(0, 0, 1, 1, 0, 0, 0))
    system = sk.NonSmoothDynamicalSystem([top])
    joint = sk.Joint.pivot(top, at=[0.0, 0.0, 0.25], axis=[1.0, 0.0, 0.0])
    system.link(sk.Interaction(joint, sk.EqualityConditionNSL(joint.size), name="pivot"), top)
    (place,) = sk.TimeStepping(system, "HalfExplicitTrapezoidalOSI", 1e-3).trajectory.places
    np.testing.assert_allclose(place.point[0], [0, 0, 0.25], atol=1e-7)
    assert place.directions.shape == (1, 3, 3)  # the rows that hold the axis are no forces
    np.testing.assert_allclose(np.abs(np.linalg.det(place.directions[0])), 1.0, atol=1e-6)


def test_corners_of_the_slider_are_where_their_gaps_say():
    run = sk.TimeStepping(slider_crank.build(), "HalfExplicitTrapezoidalOSI", 1e-4).run(0.02)
    p = slider_crank.SliderCrankParameters()
    for place in run.places:
        wall = 1 if "upper" in place.contact else -1
        np.testing.assert_allclose(
            run[place.contact].gap[:, 0], (p.b + p.c) - wall * place.point[:, 1], atol=1e-8
        )
        np.testing.assert_allclose(place.directions[:, 0, 1], -wall)
        # row 1 is the velocity of the corner along x
        smooth = np.convolve(run.impulsive, [1, 1, 1], "same")[1:-1] == 0
        measured = np.gradient(place.point[:, 0], run.t)[1:-1]
        tangential = run[place.contact].velocity[1:-1, 1] * place.directions[1:-1, 1, 0]
        np.testing.assert_allclose(tangential[smooth], measured[smooth], atol=0.01)


def test_a_place_that_is_told(tmp_path):
    a, b = (sk.LagrangianLinearTIDS([x], [0.0], [[1.0]]) for x in (0.0, 1.0))
    system = sk.NonSmoothDynamicalSystem([a, b])
    contact = sk.Interaction(
        sk.LagrangianLinearTIR([[1.0, -1.0]], [2.0]), sk.NewtonImpactNSL(0.5), name="touch"
    )
    contact.show_at(lambda q: ((q[0], q[1]), (cos(0.3), sin(0.3))))
    system.link(contact, b, a)
    del contact
    (place,) = sk.TimeStepping(system, "ExplicitMoreauJeanOSI", 0.1).trajectory.places
    np.testing.assert_allclose(place.point[0], [1.0, 0.0, 0.0])  # q = [q of ds1; q of ds2]
    np.testing.assert_allclose(place.directions[0], [[cos(0.3), sin(0.3), 0.0]], atol=1e-7)


@pytest.mark.parametrize(
    ("place", "said"),
    [
        (lambda q: ((0.0, np.nan), (1.0, 0.0)), "point and at most three directions"),
        (lambda q: ((0.0,), (1.0,)), "point and at most three directions"),
        (lambda q: ((0.0, 1.0), (1.0,)), "must be a point and directions"),
        (lambda q: 3.0, "point and at most three directions"),
        (lambda q: ((0.0, 0.0), (0.0, 1.0), (1.0, 0.0)), "no more than its rows, 1"),
    ],
)
def test_places_that_are_none(place, said):
    ball = sk.LagrangianLinearTIDS([0.0], [0.0], [[1.0]])
    system = sk.NonSmoothDynamicalSystem([ball])
    contact = sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.5), name="floor")
    contact.show_at(place)
    system.link(contact, ball)
    with pytest.raises(ValueError, match=f"place of 'floor' .*{said}|{said}"):
        _ = sk.TimeStepping(system, "ExplicitMoreauJeanOSI", 0.1).trajectory.places


def test_misuse_of_shapes():
    ball = sk.LagrangianLinearTIDS([0.0], [0.0], [[1.0]])
    with pytest.raises(TypeError, match="only a NewtonEulerDS tells where its shapes are"):
        ball.add_shape(sk.Disc(1.0))
    with pytest.raises(TypeError, match="shape must be a Disc"):
        sk.NonSmoothDynamicalSystem([ball]).add_shape("floor")
    with pytest.raises(TypeError, match="place must be a function"):
        sk.Interaction(sk.LagrangianLinearTIR([[1.0]]), sk.NewtonImpactNSL(0.5)).show_at((0.0, 0.0))
    for value in ("a", None, True):
        with pytest.raises(TypeError, match="radius must be a number, got"):
            sk.Disc(value)
    for make, said in [
        (lambda: sk.Sphere(0.0), "radius must be positive"),
        (lambda: sk.Box(1.0, 1.0, -1.0), "depth must be positive"),
        (lambda: sk.Cylinder(1.0, np.inf), "length must be positive"),
        (lambda: sk.Cylinder(1.0, 1.0, -0.5), "radius_on_top must be"),
        (lambda: sk.Polyline(((0, 0, 0, 0), (1, 1, 1, 1))), "2 or 3 entries"),
        (lambda: sk.Polyline(((0, np.nan), (1, 1))), "points must be finite"),
        (lambda: sk.Mesh([[0, 0, 0]], [[0, 0, 1]]), "faces must name points 0 ... 0"),
        (lambda: sk.Mesh([[0, 0]], [[0, 0, 0]]), "of shape"),
        (lambda: sk.Mesh([[0, 0, 0]], [[0.5, 0, 0]]), "whole numbers"),
    ]:
        with pytest.raises(ValueError, match=said):
            make()


@pytest.mark.parametrize("pose", [None, "here", lambda t: (0.0, 0.0) if t > 0 else (0.0, 0.0, 0.0)])
def test_a_pose_that_is_none_is_named(pose):
    system = sk.NonSmoothDynamicalSystem([sk.LagrangianLinearTIDS([0.0], [0.0], [[1.0]])])
    system.add_shape(sk.Disc(1.0), pose)
    with pytest.raises(ValueError, match=r"the pose of Disc\(radius=1.0\) must be three finite numbers"):
        _ = sk.TimeStepping(system, "ExplicitMoreauJeanOSI", 0.1).run(0.2).shapes
