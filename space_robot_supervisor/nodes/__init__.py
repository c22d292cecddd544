"""The supervisor as a node of the graph."""
