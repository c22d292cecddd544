"""What a supervisor does at every tick, compiled."""
