"""The log: a rosbag2 bag written, read, merged and recovered."""
