"""A paper's figures, tables and claims, flown, drawn and judged from one manifest."""
