"""A paper's figures, tables and claims: run, drawn and judged from one manifest."""
