"""The report of a run: one self-contained page, and a PDF of its main tables and figures."""
