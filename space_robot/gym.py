"""Environments for gymnasium: importing this registers the shipped experiments (extra ``gym``).

    import gymnasium
    import space_robot.gym

    env = gymnasium.make("space_robot/liu2023-fig08-v0")

``ids`` are all of them; ``SpaceRobotEnv`` makes one of any experiment.
"""

try:
    from space_robot_bringup.public.environment import SpaceRobotEnv, action_limits, tracking_reward
    from space_robot_bringup.public.gym_ids import register
except ImportError as error:
    from space_robot_msgs_py.extras import install

    raise ImportError(f"space_robot.gym needs gymnasium ({error}); {install('gym')}") from None

__all__ = ["action_limits", "ids", "SpaceRobotEnv", "tracking_reward"]

ids = register()
