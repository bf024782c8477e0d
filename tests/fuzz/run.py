"""Fuzz with new seeds until the time is over or something breaks: `make fuzz MINUTES=30`."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import time

EXAMPLES = 400  # of each kind a round; the tests that cost little take several times as many


def main(minutes: float) -> int:
    end = time.monotonic() + 60.0 * minutes
    rounds = 0
    while time.monotonic() < end:
        seed = random.SystemRandom().randrange(2**32)
        print(f"round {rounds + 1}, seed {seed}, {(end - time.monotonic()) / 60.0:.1f} min left", flush=True)
        python = [sys.executable, "-m", "pytest", "-q", "-x", "tests/fuzz", f"--hypothesis-seed={seed}"]
        rust = ["cargo", "test", "--release", "--quiet", "--features", "python", "--test", "fuzz"]
        environment = {
            "FUZZ_EXAMPLES": str(EXAMPLES),
            "PROPTEST_CASES": str(20 * EXAMPLES),
            "PROPTEST_RNG_SEED": str(seed),
            "PYO3_BUILD_EXTENSION_MODULE": "1",
        }
        for command in (python, rust):
            status = subprocess.run(command, env=os.environ | environment, check=False).returncode
            if status:
                print(f"failed with seed {seed}: {' '.join(command)}")
                return status
        rounds += 1
    print(f"{rounds} rounds without a failure")
    return 0


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1])))
