"""How large a table may be that people read."""

#: Columns, those that say which row is which among them.
MOST_COLUMNS = 10
