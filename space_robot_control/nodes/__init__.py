"""ROS nodes of the deciding side: controller and guidance."""
