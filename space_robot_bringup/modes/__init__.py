"""One run, three ways: a loop, a ROS graph in one process, one process per node."""
