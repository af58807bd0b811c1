"""Linear complementarity and friction for their own sake, of random positive definite matrices."""

import numpy as np
import siconos.numerics as sn

rng = np.random.default_rng(5)
rows = []
for _ in range(20):
    root = rng.normal(size=(6, 6))
    M = root @ root.T + np.eye(6)
    q = rng.normal(size=6)
    solutions = []
    for problem, driver, solver in (
        (sn.LCP(M, q), sn.linearComplementarity_driver, sn.SICONOS_LCP_LEMKE),
        (sn.FrictionContactProblem(2, M, q, np.full(3, 0.3)), sn.fc2d_driver, sn.SICONOS_FRICTION_2D_NSGS),
        (sn.FrictionContactProblem(3, M, q, np.full(2, 0.3)), sn.fc3d_driver, sn.SICONOS_FRICTION_3D_NSGS),
    ):
        z, w = np.zeros(6), np.zeros(6)
        options = sn.SolverOptions(solver)
        options.dparam[sn.SICONOS_DPARAM_TOL] = 1e-13
        assert driver(problem, z, w, options) == 0
        assert options.dparam[sn.SICONOS_DPARAM_RESIDU] <= 1e-12
        solutions += [z, w]
    rows.append(np.concatenate(solutions))
dataPlot = np.array(rows)
