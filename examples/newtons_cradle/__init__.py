"""Newton's cradle: simultaneous and successive impacts."""
