"""A batch's own processes in the frozen program: they start, and work at the same time. `trisect --module` runs it."""

import os
import time

from core.pipeline.executors import PROCESSES, executor_of

TOGETHER_S = 2.0
"""Longer than a process is behind the other."""

if __name__ == "__main__":
    with executor_of(PROCESSES, 2) as pool:
        list(pool.map(time.sleep, [TOGETHER_S] * 2))
        workers = {future.result() for future in [pool.submit(os.getpid) for _ in range(20)]}
    print(f"a batch works in processes: {os.getpid() not in workers and bool(workers)}")
    raise SystemExit(os.getpid() in workers)
