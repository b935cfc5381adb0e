"""The exceptions and warnings of mcgee."""


class ModelError(ValueError):
    """A robot description that cannot be used: what, where, the value, and what to do."""


class ModelWarning(UserWarning):
    """A robot description that can be used but is probably not what its author meant."""
