"""A string over frets, in its modes: the system, the interactions and the model are classes of the script."""

import math

import numpy as np
import siconos.kernel as sk

MODES, LENGTH, TENSION, DENSITY = 60, 1.0, 180.0, 1.2e-3


class String(sk.LagrangianLinearDiagonalDS):
    """Plucked at its middle."""

    def __init__(self, height):
        self.number_of_modes = MODES
        self.length = LENGTH
        modes = np.arange(1, MODES + 1)
        self.shapes = math.sqrt(2.0 / LENGTH) * np.sin(math.pi / (MODES + 1) * np.outer(modes, modes))
        omega = math.pi * modes / LENGTH * math.sqrt(TENSION / DENSITY) * np.sqrt(1 + 2e-5 * modes**2)
        places = modes / (MODES + 1)
        start = height * np.minimum(2 * places, 2 - 2 * places)
        q0 = LENGTH / (MODES + 1) * self.shapes.T @ start
        super().__init__(q0, np.zeros(MODES), omega**2, 0.01 * omega, np.ones(MODES))


class Fret(sk.Interaction):
    """A point that the string cannot pass."""

    def __init__(self, string, place, height):
        self.position = np.array([height])
        self.law = sk.NewtonImpactNSL(0.9)
        self.geometry = sk.LagrangianLinearTIR(string.shapes[place : place + 1], -self.position)
        super().__init__(self.law, self.geometry)


class Guitar(sk.NonSmoothDynamicalSystem):
    """A string and its frets, with a simulation of their own."""

    def __init__(self, string, frets, T, h):
        super().__init__(0.0, T)
        self.insertDynamicalSystem(string)
        for fret in frets:
            self.link(fret, string)
        self.integrator = sk.MoreauJeanOSI(0.5000001)
        self.steps = sk.TimeDiscretisation(0.0, h)
        self.problem = sk.LCP()
        self.simulation = sk.TimeStepping(self, self.steps, self.integrator, self.problem)


string = String(4e-3)
frets = [Fret(string, place, -5e-4 * (k + 1)) for k, place in enumerate((6, 20, 41))]
guitar = Guitar(string, frets, 0.03, 2e-5)
simulation = guitar.simulation
dataPlot = np.zeros((1500, 12))
k = 0
while simulation.hasNextEvent():
    simulation.computeOneStep()
    dataPlot[k] = [
        simulation.nextTime(),
        *string.q()[:3],
        *string.velocity()[:3],
        frets[0].y(0)[0],
        *(fret.lambda_(1)[0] for fret in frets),
        string.p(1)[0],
    ]
    k += 1
    simulation.nextStep()
