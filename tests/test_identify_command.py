"""Why an identification ended is told by the command itself, in words of the project."""

import pytest

from hypernode.commands.identify import cause_of


@pytest.mark.parametrize(
    "line",
    [
        "error: pull.yaml: thickness: missing",
        "error in import_dic (case pull): pull.yaml: thickness: missing",
        "error in constrained (case a: b, method field): pull.yaml: thickness: missing",
    ],
)
def test_the_refusal_of_a_workflow_or_of_a_job_is_the_cause(line):
    said = ["[import] pull: 20 frames", line, "Shutting down, this might take some time.", "WorkflowError:"]
    assert cause_of(said) == "pull.yaml: thickness: missing"


def test_words_of_others_are_no_cause():
    assert cause_of(["Error in rule import_dic:", "error of measurement: 3", "WorkflowError:"]) == ""
