"""The exception for ids that nothing has."""


class IdError(KeyError, ValueError):
    """No shape, particle or wall has an id that was given: it was removed, or never existed.

    It is raised for a missing id only. An id that is given twice is a `ValueError`, one that is no
    integer a `TypeError`.

    See Also
    --------
    jostle.Space.remove : Ends ids of shapes.
    jostle.World.remove : Ends ids of particles.

    Examples
    --------
    >>> import jostle
    >>> world = jostle.World([(0, 0), (5, 0)], 1.0)
    >>> world.remove(1)
    >>> try:
    ...     world.set(1, velocities=(1, 0))
    ... except jostle.IdError as error:
    ...     print(error)
    ids is 1; no particle has this id any more: it was removed, or merged into another
    """

    def __str__(self) -> str:
        # That of KeyError has quotes around the message.
        return ValueError.__str__(self)
