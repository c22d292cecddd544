"""What flows: value types, protocols, errors, the topic table, message layouts and the log file."""
