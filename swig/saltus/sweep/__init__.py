"""Runs over parameters, integrators and time steps, on one machine or many: what ``saltus sweep`` does.

A study is a Python file, see `Study`. `run_study` makes its runs, keeps each as soon as it is done, and
leaves a table and a picture; called again it makes those that are missing.
"""

from saltus.sweep.runs import Sweep, run_study
from saltus.sweep.study import Run, Samples, Study, read_study

__all__ = ["Run", "Samples", "Study", "Sweep", "read_study", "run_study"]
