"""Error (ValueError) that names the argument which would resolve it.

A command adds its option to the message.
"""


class InputRefusal(ValueError):
    """Error for an invalid input; `setting` names the argument that the user must state or change.

    Examples are `rated_torque`, `error`, `unit`.
    """

    def __init__(self, refusal_message: str, setting_name: str) -> None:
        super().__init__(refusal_message)
        self.setting = setting_name
