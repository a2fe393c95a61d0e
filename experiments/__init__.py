"""Questions answered by computation, each with a committed report."""
