"""The loop of a worker: read a problem, solve it on request, and report the time.

Requests and replies are lines with one JSON object. A request contains the file of the problem, the
tolerance of the program, the file for the pressure (Pa) and the time for which the solve is
repeated. The reply lists the seconds of each solve. A solve starts only from the input data of the
program: `forget` removes everything that the program keeps from earlier solves.
"""

from __future__ import annotations

import gc
import json
import os
import sys
import time
from types import SimpleNamespace

import numpy as np


def serve(version, prepare, solve, forget=lambda: None):
    """Answer requests until the input ends.

    `prepare(problem)` makes the input that a user of the program would hold, before the clock
    starts; `solve(inputs, tolerance)` is timed and returns the pressure in Pa.
    """
    replies = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # what programs print must not come between the replies
    print(json.dumps({"version": version}), file=replies)
    for line in sys.stdin:
        request = json.loads(line)
        try:
            reply = _repeat(request, prepare, solve, forget)
        except Exception as error:  # a program that fails on a problem is a result
            reply = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(reply), file=replies)


def _repeat(request, prepare, solve, forget):
    with np.load(request["problem"]) as file:
        problem = SimpleNamespace(**{key: file[key][()] for key in file.files})
    times = []
    while not times or sum(times) < request["least_seconds"]:
        inputs = prepare(problem)
        forget()
        gc.collect()
        began = time.perf_counter()
        pressure = solve(inputs, request["tolerance"])
        times.append(time.perf_counter() - began)
    np.save(request["pressure"], np.asarray(pressure).reshape(problem.gap.shape))
    return {"seconds": times}
