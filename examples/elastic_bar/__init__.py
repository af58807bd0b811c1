"""The elastic bar (Section 6.1 of the paper)."""
