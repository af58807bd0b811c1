"""A pile of discs: contacts of rolling bodies that come and go."""
