"""The fixture `compare_integrators` for test suites; pytest finds it where Saltus is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

    from saltus.compare import Comparison


@pytest.fixture
def compare_integrators() -> Callable[..., Comparison]:
    """A function with the arguments of `saltus.compare.compare` that fails the test if a limit is broken.

    It returns the comparison, and prints its table, which pytest shows if the test fails::

        def test_hopper(compare_integrators):
            compare_integrators(build, ["MoreauJeanOSI"], time_steps=[1e-3], until=1.0, max_error=1e-2)
    """

    def check(*arguments: Any, **settings: Any) -> Comparison:
        from saltus.compare import compare  # only where it is used: pytest loads this file in every run

        found = compare(*arguments, **settings)
        print(found)
        if not found.ok:
            pytest.fail("\n".join(breach.message for breach in found.breaches), pytrace=False)
        return found

    return check
