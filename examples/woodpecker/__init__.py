"""The woodpecker toy: a limit cycle of sticking, sliding and impacts."""
