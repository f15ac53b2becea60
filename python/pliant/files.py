"""Files: written to a temporary name first and then put in place, so that no crash leaves half a file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from pliant.errors import FileError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["atomic"]


@contextmanager
def atomic(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary path beside ``path``; on success it replaces ``path``, on failure it is removed."""
    from pathlib import Path

    target = Path(path)
    temporary = target.with_name(f".{target.name}.{os.urandom(16).hex()}")
    try:
        yield temporary
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        temporary.replace(target)
    except OSError as error:
        raise FileError(f"{target}: cannot be written: {error}") from error
    finally:
        temporary.unlink(missing_ok=True)
