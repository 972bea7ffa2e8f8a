"""How many messages of a numbered sequence never came."""


class Gaps:
    """Counts the numbers, from 1 on, that were passed over: what a full queue dropped on the way."""

    def __init__(self) -> None:
        self.came = 0
        self.last = 0

    def take(self, number: int) -> None:
        """Takes the number of a message that came; what comes twice or late counts once as come."""
        self.came += 1
        self.last = max(self.last, number)

    @property
    def lost(self) -> int:
        return self.last - self.came
