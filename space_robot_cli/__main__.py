"""``python -m space_robot_cli`` is ``space-robot``."""

from space_robot_cli.main import main

if __name__ == "__main__":
    main()
