"""How well sheets of known materials know the level of their stress, and whether wrong laws are refuted."""
