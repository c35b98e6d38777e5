"""The documentation site: pages of the repository beside pages that are made from the program itself."""
