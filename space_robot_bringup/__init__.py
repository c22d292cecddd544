"""What is COMPOSED: experiment file in, objects and runs out."""
