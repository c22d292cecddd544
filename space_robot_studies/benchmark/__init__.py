"""The open benchmark: laws tuned with one budget on a versioned set of tasks, judged in pairs on held-out draws."""
