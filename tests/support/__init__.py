"""What tests of several packages share: robots, values, laws that fail, a graph under test."""
