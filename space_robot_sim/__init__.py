"""What happens: the true robot with its actuators and sensors. ROS only in `nodes`."""
