"""Stage 6: a hyper-network that gives the homogenised parameters everywhere."""

from hypernode.config.methods import Method
from hypernode.stages.hypernetwork_files import open_problem, save
from hypernode.training.hypernetwork import initialise


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Train the hyper-network of one case and write it.

    Args:
        files: paths of the earlier stages' files, see :class:`~hypernode.training.problem.InverseProblem`.

    Raises:
        DivergenceError: the loss is no longer finite.
    """
    problem = open_problem(method, name, files)
    save(problem, initialise(problem), "initialised hyper-network", files, output, attributes)
