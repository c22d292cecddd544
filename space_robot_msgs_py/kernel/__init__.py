"""What compiled numbers are made of and the log needs too: elementary functions."""
