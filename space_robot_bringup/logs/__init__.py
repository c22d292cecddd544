"""What is in a log: for people and programs that look at one without computing anything again."""
