"""Dry friction with exact solutions: a block on a slope, an oscillator, a ball that begins to roll."""
