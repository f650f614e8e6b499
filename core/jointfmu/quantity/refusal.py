"""Error (ValueError) that names the argument which would resolve it.

A command adds its option to the message.
"""


class InputRefusal(ValueError):
    """Invalid input; `setting` is the argument that would resolve it (`rated_torque`, `error`, `unit`)."""

    def __init__(self, message: str, setting_name: str) -> None:
        super().__init__(message)
        self.setting = setting_name
