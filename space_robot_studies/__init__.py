"""What many runs say: campaigns, comparisons, reproductions of papers."""
