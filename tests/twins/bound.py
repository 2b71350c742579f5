"""How far two engines may be apart, from how far each is from itself at other steps.

Each engine runs at the steps h, h/2 and h/4. For a method of first order, or a higher one, the result at h/4 is off by no more
than its difference to that at h/2, and half of the difference of those at h and h/2. The larger of the two, or the sum of both
differences where something meets, stops or sticks, at this sample or a sample before, is the engine's error; the bound is `SAFETY`
times the sum of both errors, plus `FLOOR`. What is soft in MuJoCo becomes stiff with the step, so this error has that in it. One
thing it has not: MuJoCo's stops give way by a speed times some steps, by how much depends on the phase of the step in which they
are hit, and so does what a mechanism does from there on. That way is added.
"""

import numpy as np

# Time between two samples, s.
EVERY_S = 0.02
SAFETY = 3.0
# What numbers in double precision and a solver's tolerance leave, per metre or radian.
FLOOR = 1e-6
# Error of a method of order one half beside its last change: MuJoCo's friction in contacts (theirs.py) goes with the root of
# the step.
HALF_ORDER = 1 / (2 ** 0.5 - 1)
# The change of extrapolated results beside that of plain ones below which a result is smooth in the step.
SMOOTH = 0.3
# No extrapolation is trusted to take away more than all but this share of an error.
SMALLEST = 0.02
# A bound beyond this share of what moves says nothing.
LOOSE = 0.1


def error(runs, name, is_smooth):
    """Of a quantity at h/4. When something meets, stops or sticks depends on the phase of a step, so that each change may be small
    by chance: there both count."""
    coarse, middle, fine = (one[name] for one in runs)
    last, before = np.abs(fine - middle), np.abs(middle - coarse)
    each = np.maximum(last, before / 2) if is_smooth else last + before
    # an event between two samples shows in the next one first
    each[:-1] = np.maximum(each[:-1], each[1:])
    return np.maximum.accumulate(each)


def best(runs, name, is_smooth):
    """What an engine says of a quantity, and its error.

    Where nothing meets, stops or sticks, the result is smooth in the step: twice that of h/4 less that of h/2 has no first order
    left, and what is left is less than its change from the coarser pair. The runs decide whether it is so.
    """
    coarse, middle, fine = (one[name] for one in runs)
    plain = error(runs, name, is_smooth)
    if not is_smooth:
        return fine, plain
    rest = np.abs(2 * fine - middle - (2 * middle - coarse))
    rest[:-1] = np.maximum(rest[:-1], rest[1:])
    rest = np.maximum.accumulate(rest)
    if rest[-1] < SMOOTH * plain[-1]:
        return 2 * fine - middle, np.maximum(rest, SMALLEST * plain)
    return fine, plain


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


def compare(ours, theirs, is_smooth, factor=1.0, gives_s=0.0):
    """Of three runs each, from the coarsest step to the finest; `factor` is of the second engine's error, and its stops give way
    for `gives_s`."""
    names = sorted(set(theirs[-1]) & set(ours[-1]))
    worst, spans, bounds = None, [], []
    # what hits a stop in one place moves all others
    fastest = np.max([np.abs(np.diff(theirs[-1][name], append=theirs[-1][name][-1])) for name in names], axis=0)
    gives = gives_s / EVERY_S * np.maximum.accumulate(fastest)
    for name in names:
        (mine, my_error), (yours, your_error) = best(ours, name, is_smooth), best(theirs, name, is_smooth)
        # a closed form may end before the runs do
        count = min(len(mine), len(yours))
        mine, my_error, yours, your_error = (one[:count] for one in (mine, my_error, yours, your_error))
        difference = np.abs(mine - yours)
        limit = SAFETY * (my_error + factor * your_error) + gives[:count] + FLOOR * (1 + np.abs(yours))
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
