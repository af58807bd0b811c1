"""The rotor with a journal bearing (Section 6.2 of the paper)."""
