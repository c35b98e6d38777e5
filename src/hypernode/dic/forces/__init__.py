"""Forces of testing machines: their records, the clock of these, and what no sheet can give."""
