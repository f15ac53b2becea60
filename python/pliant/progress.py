"""The progress bar: on a terminal, never in a pipe."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

__all__ = ["progress_bar"]


@contextmanager
def progress_bar(progress: bool | None, total: int) -> Iterator[Callable[[int], object]]:
    """Give a function that takes the number of steps done; ``progress`` None: a bar on a terminal only."""
    if progress or (progress is None and sys.stderr is not None and sys.stderr.isatty()):
        try:
            from tqdm import tqdm
        except ImportError as error:
            if progress:
                raise ImportError('the progress bar needs tqdm: pip install "pliant[progress]"') from error
        else:
            with tqdm(total=total, leave=False, file=sys.stderr) as bar:
                yield bar.update
            return
    yield lambda _: None
