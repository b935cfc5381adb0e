"""What every test runs under: a cache of its own, reproducible examples, no silent skips in CI."""

import gc
import os
import tempfile
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

CI = os.environ.get("CI", "").lower() == "true"

_slow_to_build = [HealthCheck.too_slow, HealthCheck.data_too_large]
settings.register_profile(
    "ci", max_examples=20, deadline=None, derandomize=True, suppress_health_check=_slow_to_build
)
settings.register_profile(
    "local", max_examples=12, deadline=None, suppress_health_check=_slow_to_build
)
settings.load_profile("ci" if CI else "local")

_cache = pytest.StashKey[tempfile.TemporaryDirectory]()


def pytest_configure(config: pytest.Config) -> None:
    """Nothing is compiled from, or into, the user's own cache, not even during collection."""
    # graphs are many small objects; collecting them took 40 % of the time
    gc.set_threshold(100_000)
    if hasattr(config, "workerinput"):
        return  # a worker shares the cache of the session that started it
    folder = tempfile.TemporaryDirectory(prefix="mcgee-tests-")
    config.stash[_cache] = folder
    os.environ["MCGEE_CACHE_DIR"] = folder.name


def pytest_unconfigure(config: pytest.Config) -> None:
    if _cache in config.stash:
        os.environ.pop("MCGEE_CACHE_DIR", None)
        config.stash[_cache].cleanup()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo
) -> Iterator[pytest.TestReport]:
    return _not_skipped((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Iterator[pytest.CollectReport]:
    return _not_skipped((yield))


def _not_skipped(report):
    """A user may lack a tool; CI must have all of them."""
    if CI and report.skipped and not hasattr(report, "wasxfail"):
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"{report.nodeid} was skipped, and CI may skip nothing. {reason}"
    return report


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20250219)
