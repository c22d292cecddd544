"""What bends, twists and sloshes in the real robot: bodies on springs that no law knows, and gears that give."""
