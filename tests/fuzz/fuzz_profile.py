"""How much is tried: a little with every run of the tests, more with `make fuzz MINUTES=30`."""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

# The same cases in every run of the tests; `make fuzz` gives the number of examples and a seed of its own.
IS_NEW = "FUZZ_EXAMPLES" in os.environ
EXAMPLES = int(os.environ.get("FUZZ_EXAMPLES", "60"))
settings.register_profile(
    "fuzz",
    max_examples=EXAMPLES,
    derandomize=not IS_NEW,
    database=None,
    deadline=20_000.0,  # nothing may take longer (ms)
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much],
)
settings.load_profile("fuzz")
