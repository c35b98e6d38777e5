"""The explorer: one HTML file in which a sheet is asked for its stress-stretch curve at any point."""
