"""Stage 7: a heterogeneous material whose stress under the measured deformation is already plausible."""

from hypernode.config.methods import Method
from hypernode.stages.hypernetwork_files import open_problem, save
from hypernode.training.hypernetwork import pretrain


def run(method: Method, name: str, files: dict[str, str], output: str, attributes: dict) -> None:
    """Train the hyper-network of one case and write it.

    Args:
        files: paths of the earlier stages' files, see :class:`~hypernode.training.problem.InverseProblem`.

    Raises:
        DivergenceError: the loss is no longer finite.
    """
    problem = open_problem(method, name, files)
    save(problem, pretrain(problem), "pre-trained hyper-network", files, output, attributes)
