"""ROS nodes of the happening side: simulator and recorder."""
