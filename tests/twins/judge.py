"""Runs a scene in both engines and says what came of it."""

import bound
import closed
import coulomb
import known
import laws
import layers
import ours
import scene as scenes
import theirs

EVERY_US = round(bound.EVERY_S * 1e6)
# MuJoCo's coarsest step; with contacts it is finer.
THEIRS_US = 200
THEIRS_IN_TOUCH_US = 100
# Of the coarsest step, in three runs; and once more where they differ.
PARTS, FINER = (1, 2, 4), (2, 4, 8)

EQUAL, APART, LOOSE, LEFT_OUT, KNOWN, FINDING = "equal", "MuJoCo apart", "loose", "left out", "known", "finding"


class Verdict:
    """What came of a scene: a kind, what it is about, a line of text, and how large the bound is beside what moves."""

    def __init__(self, kind, what="", text="", row=None):
        self.kind, self.what, self.text, self.row = kind, what, text, row


def verdict(program, scene, other=None):
    """Of a scene; `other` is what MuJoCo is given in its place, for the canary."""
    try:
        mine = our_runs(program, scene, PARTS)
    except ours.Refused as refused:
        return Verdict(FINDING, "refused", str(refused))
    for name, amount, limit in laws.broken(scene, mine, EVERY_US):
        if not amount <= limit:
            return settled(scene, mine, name, amount, f"law of {name}: broken by {amount:.3g}, allowed {limit:.3g}")
    truth = law_of_coulomb(scene)
    if truth:
        against = bound.compare(mine, truth, False)
        if against.differs:
            return settled(scene, mine, "law", against.difference, f"the closed form: {described(against)}")
    try:
        against = beside(scene, mine, their_runs(other or scene, PARTS), PARTS)
        if against.differs and not truth:
            # By the phase of a step an engine may change little from one step to the next and then jump: what differs is
            # looked at again with finer ones.
            against = beside(scene, our_runs(program, scene, FINER), their_runs(other or scene, FINER), FINER)
    except theirs.Unfit as unfit:
        return Verdict(LEFT_OUT, "unfit", str(unfit))
    if against.differs:
        if truth:
            return Verdict(APART, against.name, f"MuJoCo, and the closed form agrees with onescan: {described(against)}")
        return settled(scene, mine, "apart", against.difference, f"MuJoCo: {described(against)}")
    return Verdict(LOOSE if against.loose else EQUAL, against.name, described(against))


def our_runs(program, scene, parts):
    return [ours.run(program, scene, scene["step_us"] // part, EVERY_US) for part in parts]


def coarsest_us(scene):
    return THEIRS_IN_TOUCH_US if any(one["collides"] for one in scene["bodies"]) else THEIRS_US


def their_runs(scene, parts):
    return [theirs.run(scene, coarsest_us(scene) // part, EVERY_US) for part in parts]


def beside(scene, mine, yours, parts):
    """Our runs beside theirs, of steps that are these parts of the coarsest."""
    factor = bound.HALF_ORDER if scenes.touching(scene) else 1.0
    gives_s = 2 * theirs.SOFT * coarsest_us(scene) / (parts[-1] * 1e6) if scenes.has_stops(scene) else 0.0
    return bound.compare(mine, yours, scenes.is_smooth(scene), factor, gives_s)


def settled(scene, mine, what, amount, text):
    """A difference: known, with its reason, or a finding."""
    row = known.row(scene, mine, what, amount)
    return Verdict(KNOWN, what, text, row.name) if row else Verdict(FINDING, what, text)


def law_of_coulomb(scene):
    """The closed form where there is one, as three runs. What falls lands within a step of onescan's; by which part of it may by
    chance be alike at all steps, so a landing that is late by the finest step counts as an error."""
    run = coulomb.path(scene, EVERY_US)
    if run:
        return [coulomb.path(scene, EVERY_US, scene["step_us"] / PARTS[-1] * 1e-6), run, run]
    run = layers.path(scene, EVERY_US) or closed.path(scene, EVERY_US)
    return run and [run] * 3


def described(against):
    return (f"{against.name} at {against.sample * EVERY_US // 1000} ms is {against.difference:.3g} off, "
            f"allowed {against.bound:.3g}")


def canary(program):
    """A spring whose mass is 1 % larger for MuJoCo: true if that is found."""
    one = scenes.empty("canary", 0)
    scenes.body(one, "mass", shape="box", size_m=[0.1, 0.1, 0.1], position_m=[0.0, 0.0, 0.0], mass_kg=2.0)
    scenes.joint(one, "guide", "prismatic", "ground", "mass", axis=[1.0, 0.0, 0.0])
    one["fittings"].append({"joint": "guide", "spring": 200.0, "rest": 0.1})
    other = scenes.changed(one)
    other["bodies"][0]["mass_kg"] *= 1.01
    return verdict(program, one).kind == EQUAL and verdict(program, one, other).kind == FINDING
