"""Worked examples, each a document to read."""
