"""One thin module a rule: read, call, write."""
