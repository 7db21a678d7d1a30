"""The two ways in which LensBench fails: the input is wrong (exit 2), or this machine lacks something (exit 1)."""


class LensBenchError(Exception):
    """A failure with one clear sentence for the user."""

    exit_code = 1


class InputError(LensBenchError):
    """The user's file or option is wrong; the sentence names the place, what is wrong and what would be right."""

    exit_code = 2
