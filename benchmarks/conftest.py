"""Puts the measured ratios into words at the end of a benchmark run."""

import os
from typing import Any

os.environ.setdefault("JAX_PLATFORMS", "cpu")


def pytest_terminal_summary(terminalreporter, config):
    """One line a group: throughput, ratio to the NumPy peer, and what compiling costs once."""
    session = getattr(config, "_benchmarksession", None)
    groups: dict[str, dict[str, Any]] = {}
    for bench in session.benchmarks if session else ():
        groups.setdefault(bench.group, {})[bench.extra_info["implementation"]] = bench
    for group, found in sorted(groups.items()):
        if {"axffit", "numpy"} <= set(found):
            own, peer = found["axffit"], found["numpy"]
            rate = own.extra_info["evaluations"] / own.stats.median / 1e6
            terminalreporter.write_line(
                f"{group}: {rate:.0f} million evaluations/s, {peer.stats.median / own.stats.median:.1f} times NumPy; "
                f"compiled once in {own.extra_info['compile_seconds']:.2f} s"
            )
