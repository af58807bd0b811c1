"""The bouncing ball: one freedom, one contact, everything known in closed form."""
