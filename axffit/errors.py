"""The one exception for input that cannot be used."""


class InputError(ValueError):
    """Unusable input: a file, a value or a name given by the user.

    The message is one line and says what was wrong, which value, what is allowed and how to mend it. The command
    line prints it as it stands and exits with 2; everything else is a defect of axffit and keeps its traceback.
    """
