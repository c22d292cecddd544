"""Laws side by side: one campaign, a table of what each did at each period and in each condition."""
