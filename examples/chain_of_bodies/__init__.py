"""A chain of rigid bodies under ball joints."""
