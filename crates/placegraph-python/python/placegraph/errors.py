"""What can go wrong. The texts are those of the program: what is wrong, where, and what to do."""

import errno as _errno

__all__ = [
    "EditError",
    "Error",
    "ExportError",
    "FileError",
    "InternalError",
    "MapError",
    "MissingFileError",
    "ModelError",
    "NoRouteError",
    "TopologyError",
    "TrainingError",
]


class Error(Exception):
    """Base of all exceptions of this package."""


class MapError(Error, ValueError):
    """A map file, or an array, is no map that can be read."""


class ModelError(Error, ValueError):
    """A model file cannot be read."""


class TopologyError(Error, ValueError):
    """A topological map cannot be read, or has no such place."""


class NoRouteError(TopologyError):
    """No way leads from one place to the other."""


class EditError(Error, ValueError):
    """Corrections by hand cannot be read."""


class TrainingError(Error, ValueError):
    """No model can be trained from these maps and settings."""


class ExportError(Error, ValueError):
    """A format cannot hold this map."""


class FileError(Error, OSError):
    """The system does not give a file. ``errno`` and ``filename`` say why and which."""

    def __str__(self) -> str:
        # The text names the file already.
        return str(self.args[0]) if self.args else ""


class MissingFileError(FileError, FileNotFoundError):
    """A file does not exist."""


class InternalError(Error, RuntimeError):
    """A bug in placegraph: please report it with what led to it."""


def file_error(text: str, number: int, filename: object) -> FileError:
    """The exception with this text for a file that the system does not give."""
    error = (MissingFileError if number == _errno.ENOENT else FileError)(text)
    error.errno, error.filename = number, filename
    return error
