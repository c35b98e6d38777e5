"""The configuration: its sections, how it is read and checked, and what of it each rule sees."""
