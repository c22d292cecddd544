"""What goes wrong in the real robot, by plan: a class per kind, and the stages of the plant they act on."""
