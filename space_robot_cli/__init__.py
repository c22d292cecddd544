"""What is typed: the commands of space-robot."""
