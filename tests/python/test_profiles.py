"""Performance profiles, against values computed by hand."""

from math import inf, nan

import pytest
from saltus.numerics.profiles import performance_profile


def test_a_profile_by_hand():
    times = {"a": [1.0, 4.0, inf, inf, 6.0], "b": [2.0, 2.0, 3.0, inf, 3.0], "c": [inf] * 5}
    assert performance_profile(times) == {
        "a": [(1.0, 0.2), (2.0, 0.6)],  # ratios 1, 2, ∞, ∞, 2
        "b": [(1.0, 0.6), (2.0, 0.8)],  # ratios 2, 1, 1, ∞, 1
        "c": [],
    }
    assert performance_profile({"a": [0.3, 0.5]}) == {"a": [(1.0, 1.0)]}
    assert performance_profile({"a": [], "b": []}) == {"a": [], "b": []}


@pytest.mark.parametrize("time", [0.0, -1.0, nan])
def test_a_profile_is_refused_where_it_has_no_meaning(time):
    with pytest.raises(ValueError, match="times must be positive, got .* of 'b'"):
        performance_profile({"a": [1.0], "b": [time]})
    with pytest.raises(ValueError, match="a time for each problem, got {'a': 1, 'b': 2}"):
        performance_profile({"a": [1.0], "b": [1.0, 2.0]})
