"""The bouncing ball in a box (Section 5.2 of the paper)."""
