"""The compiler of jobs for every test, in double precision, so that laws can be asserted tightly."""

import os


def set_up_as_jobs_do():
    """Set JAX up; what tests start are processes of their own, which set theirs up as users' do."""
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
    given = dict(os.environ)
    from hypernode.pipeline.compiler import set_up_compiler

    set_up_compiler(float64=True)
    import jax

    # It reads the environment of this moment.
    jax.devices()
    os.environ.clear()
    os.environ |= given


set_up_as_jobs_do()


def pytest_addoption(parser):
    parser.addoption("--smoke", action="store_true", help="also run the whole DAG on a small case")
    parser.addoption("--accuracy", action="store_true", help="also hold the tables of config/accuracy.yaml in bounds")
    parser.addoption("--endurance", action="store_true", help="also kill runs and fill disks, for minutes")
    parser.addoption("--cluster", action="store_true", help="also run through a queue that kills for memory")
    parser.addoption("--slurm", action="store_true", help="also run through a Slurm of one node, as root")
    parser.addoption("--wheel", action="store_true", help="also install a wheel in new environments, for minutes")
    parser.addoption(
        "--pythons", action="store_true", help="also run tests with every Python that is here, for minutes"
    )
    parser.addoption("--blocks", action="store_true", help="also run every block of the documentation, for minutes")
