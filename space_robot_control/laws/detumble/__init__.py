"""Detumble: rates to zero while the arm keeps its shape, a safe law."""
