"""A heavy top on a ball joint: spatial rotations and a bilateral constraint."""
