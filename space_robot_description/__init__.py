"""What the robot IS: URDF and YAML in, Pinocchio model out."""
