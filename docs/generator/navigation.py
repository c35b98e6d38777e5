"""Which pages the site has, in which order, and under which headings."""

#: Heading -> pages, from the folder of the documentation. Pages that are made from the program are among them.
NAVIGATION = {
    "Begin": ("tutorial", "gallery", "experiments", "everything"),
    "How to": (
        *("how-to/add-a-case", "how-to/use-your-own-dic-data", "how-to/several-tests", "how-to/forces"),
        "how-to/printed-sheet",
        *(
            "how-to/lost-points-holes-and-masks",
            "how-to/noise",
            "how-to/read-verdicts",
            "how-to/next-test",
            "how-to/predict",
            "how-to/challenge",
            "how-to/export",
            "examples/README",
        ),
        *("how-to/photograph-a-sheet", "how-to/correlate-your-pictures", "how-to/resume-after-a-crash", "how-to/audit"),
        *("how-to/clusters", "how-to/populations", "how-to/gpu"),
    ),
    "Reference": (
        *("../config/README", "reference/configuration", "reference/commands", "schema", "reference/interface"),
        "glossary",
    ),
    "Background": (
        *(
            "how-identification-decides",
            "constants",
            "equations",
            "paper",
            "accuracy",
            "peers",
            "decisions/index",
            "CHANGELOG",
            "CONTRIBUTING",
        ),
    ),
}


def menus() -> str:
    """The tables of contents that the first page ends with."""
    blocks = []
    for heading, pages in NAVIGATION.items():
        blocks += ["", "```{toctree}", f":caption: {heading}", ":maxdepth: 1", "", *pages, "```"]
    return "\n".join([*blocks, ""])
