"""What every node of the graph has in common."""
