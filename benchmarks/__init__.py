"""How fast it is: every table compares things inside one run, because machines differ and neighbours are noisy."""
