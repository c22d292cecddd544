"""``python -m space_robot_bringup`` is ``space-robot``."""

from space_robot_bringup.cli import main

if __name__ == "__main__":
    main()
