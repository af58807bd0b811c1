"""Panels of pictures of runs: functions (axes, trajectory). `saltus.plot` has them all."""
