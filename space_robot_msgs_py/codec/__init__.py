"""Values and messages to and from canonical CDR bytes."""
