"""The impacting slider crank with dry friction (Section 2.1 of the paper)."""
