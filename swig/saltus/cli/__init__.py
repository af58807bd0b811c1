"""The command ``saltus``: app.py reads its words, the other files do the work."""
