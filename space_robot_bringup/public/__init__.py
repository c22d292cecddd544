"""What `import space_robot` hands out of this package: runs and replays as Python calls, their results as objects."""
