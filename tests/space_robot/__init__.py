"""Tests of what `import space_robot` hands out."""
