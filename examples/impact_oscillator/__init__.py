"""A driven oscillator that hits a stop once in every period."""
