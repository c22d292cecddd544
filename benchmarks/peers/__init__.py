"""Engines that this product is compared with; they run in an environment of their own and import nothing of it."""
