"""A refusal that another setting would lift: the message names the thing, a command adds its option."""


class Refusal(ValueError):
    """Bad input; `setting` is the name of the argument that would help (`rated_torque`, `error`, `unit`)."""

    def __init__(self, message: str, setting: str) -> None:
        super().__init__(message)
        self.setting = setting
