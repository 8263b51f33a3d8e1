"""Data to matplotlib figures; no files, no computing."""
