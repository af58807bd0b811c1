"""A rocking block: corners that take turns, Housner's impact, tipping over."""
