"""A ball on a string that goes slack: bilateral and unilateral constraints."""
