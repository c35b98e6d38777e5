"""Where a descent ends early."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Plateau:
    """Where a descent ends early because other terms follow: its misfit hardly falls any more.

    Attributes:
        share, iterations: less than this share of the misfit in this many iterations, beyond the convex start.
        above: misfit below which it goes on regardless.
        left: share of the cost that misfits have, below which it goes on as well.
    """

    share: float
    iterations: int
    above: float = 0.0
    left: float = 0.0

    def reached(self, history, data_share: float, convex_iterations: int) -> bool:
        """Whether the last misfit lies on it, which has that share of the cost."""
        if len(history) <= convex_iterations + self.iterations or data_share < self.left:
            return False
        return history[-1] > max(self.above, (1.0 - self.share) * history[-1 - self.iterations])
