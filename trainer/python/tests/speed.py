"""Times 100,000 accelerations, for comparison with `cargo run --release -p leastaction-replica --example accelerations`, and the scaling
with threads.

    RAYON_NUM_THREADS=1 python tests/speed.py m.postcard
"""

import sys
import threading
import time

import numpy as np

import leastaction as la

STATES = 100_000


def least(work, repeats=10):
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return 1e3 * min(times)


model = la.load(sys.argv[1])
n = model.n
numbers = (np.sin(np.arange(3 * n * STATES, dtype=np.float32) * np.float32(0.37)) * np.float32(0.5)).reshape(STATES, 3, n)
q, v, u = (np.ascontiguousarray(numbers[:, k]) for k in range(3))
doubles = [x.astype(float) for x in (q, v, u)]
print(f"{model!r}")
print(f"float32 arrays        {least(lambda: model.acceleration(q, v, u)):8.2f} ms")
print(f"float64 arrays        {least(lambda: model.acceleration(*doubles)):8.2f} ms")
print(f"in double precision   {least(lambda: model.double.acceleration(*doubles)):8.2f} ms")
for count in (1, 2, 4):

    def work(count=count):
        parts = [(q[k::count].copy(), v[k::count].copy(), u[k::count].copy()) for k in range(count)]
        threads = [threading.Thread(target=model.acceleration, args=part) for part in parts]
        [thread.start() for thread in threads]
        [thread.join() for thread in threads]

    print(f"{count} threads of Python   {least(work, 6):8.2f} ms")
one = [x[0] for x in (q, v, u)]
print(f"one state             {least(lambda: [model.acceleration(*one) for _ in range(1000)]):8.2f} us")
