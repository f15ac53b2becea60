"""Fixtures that every test may use."""

from __future__ import annotations

import signal

import matplotlib
import pliant as pl
import pytest

matplotlib.use("Agg")

# Jobs in the background of a shell ignore interrupts, which some tests send.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def rubber() -> pl.LinearElastic:
    return pl.LinearElastic(youngs_modulus=1e7, poisson_ratio=0.45, density=1000.0)


@pytest.fixture
def steel() -> pl.LinearElastic:
    return pl.LinearElastic(youngs_modulus=2.1e11, poisson_ratio=0.3, density=7850.0)
