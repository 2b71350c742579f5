"""How far two engines may be apart, from how far each is from itself at other steps.

Each engine runs at the steps h, h/2 and h/4. For a method of first order, or a higher one, the result at h/4 is off by no more
than its difference to that at h/2, and half of the difference of those at h and h/2. The larger of the two, at this sample or a
sample before, is the engine's error; the bound is `SAFETY` times the sum of both errors, plus `FLOOR`. What is soft in MuJoCo
becomes stiff with the step, so this error has that in it.
"""

import numpy as np

SAFETY = 3.0
# What numbers in double precision and a solver's tolerance leave, per metre or radian.
FLOOR = 1e-6
# A bound beyond this share of what moves says nothing.
LOOSE = 0.1


def error(runs, name):
    coarse, middle, fine = (one[name] for one in runs)
    each = np.maximum(np.abs(fine - middle), np.abs(middle - coarse) / 2)
    # an event between two samples shows in the next one first
    each[:-1] = np.maximum(each[:-1], each[1:])
    return np.maximum.accumulate(each)


def allowed(names, ours, theirs):
    """The bound of each quantity. All share in the largest error of an engine: what moves in one place moves others."""
    return {name: SAFETY * (error(ours, name) + error(theirs, name)) + FLOOR * (1 + np.abs(theirs[-1][name])) for name in names}


class Outcome:
    """The worst quantity of a comparison."""

    def __init__(self, name, sample, difference, bound, loose):
        self.name, self.sample, self.difference, self.bound, self.loose = name, sample, difference, bound, loose

    @property
    def differs(self):
        return self.difference > self.bound

    @property
    def excess(self):
        return self.difference / self.bound


def compare(ours, theirs):
    """Of three runs each, from the coarsest step to the finest."""
    names = sorted(set(theirs[-1]) & set(ours[-1]))
    worst, spans, bounds = None, [], []
    limits = allowed(names, ours, theirs)
    for name in names:
        difference = np.abs(ours[-1][name] - theirs[-1][name])
        limit = limits[name]
        sample = int(np.argmax(difference / limit))
        found = Outcome(name, sample, float(difference[sample]), float(limit[sample]), False)
        spans.append(float(np.ptp(theirs[-1][name])))
        bounds.append(float(limit[-1]))
        if worst is None or found.excess > worst.excess:
            worst = found
    # of the quantity that moves most
    most = int(np.argmax(spans))
    worst.loose = bounds[most] > LOOSE * max(spans[most], 1e-4)
    return worst
