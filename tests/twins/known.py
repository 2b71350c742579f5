"""Differences that are known: a row each, with its reason. A row is not a looser bound: what is beyond it is a finding, and so is
what is not as the row says (`when`), of the scene and of onescan's runs."""

import math

import numpy as np

import bound
import scene as scenes


class Row:
    def __init__(self, name, families, whats, most, reason, when=lambda scene, runs: True):
        self.name, self.families, self.whats, self.most, self.reason, self.when = name, families, whats, most, reason, when


def turned_over(scene, runs):
    """A revolute joint with a spring went on to more than half a turn from its rest."""
    sprung = [one for one in scene["fittings"] if one.get("spring")]
    turns = [one for one in sprung if scenes.named(scene, "joints", one["joint"])["kind"] == "revolute"]
    return any(np.max(np.abs(runs[-1][f"{one['joint']}.q"] - one["rest"])) > math.pi for one in turns)


def never_settles(scene, runs):
    """Half a step changes what moves by more than a share of its way, although nothing meets, stops or sticks."""
    middle, fine = runs[-2:]
    return scenes.is_smooth(scene) and any(
        np.max(np.abs(fine[name] - middle[name])) > bound.LOOSE * max(np.ptp(fine[name]), 1e-2)
        for name in fine if name.endswith((".q", ".x", ".y", ".z")))


# What the face of a pusher carries of a weight (see below), and its way at most: with a friction of 0.9, in half a second.
FACE_SHARE = 2e-5
FACE_M = FACE_SHARE * 0.9 * 9.81 * 0.5 ** 2 / 2

ROWS = [
    Row("friction turned", ["slide", "belt"], ["law", "friction"], 0.05,
        "the engine's friction at a sliding contact is not exactly against the velocity, as a contact's mass differs by direction: "
        "a box that slides at an angle to its edges goes off its way by up to 2 % of what friction takes"),
    Row("rolling on an edge", ["roll"], ["law", "friction", "sinking"], 0.02,
        "the engine keeps the contact points of cylinders and capsules for up to 1 mm or 1 degree, so that weight turns them"),
    Row("slipping on a turntable", ["table"], ["apart"], 0.2,
        "rigid bodies leave open how four corners share a weight, and what slips and turns goes by it; the engine's turned friction, "
        "too"),
    Row("weight on a face", ["pusher"], ["law"], FACE_M,
        "the face of a pusher carries about 1.2e-5 of the weight of the box, at any step: the quotient of two small numbers by "
        "which normals and friction are solved (1e-11 and 1e-6)"),
    Row("spring beyond half a turn", ["floating"], ["apart"], math.inf,
        "the engine moves mechanisms that hang on nothing, and its springs do not count turns: half a turn from its rest the torque "
        "of a spring jumps to the other side", turned_over),
    Row("joints that swing up", ["floating"], ["apart"], math.inf,
        "the engine moves mechanisms that hang on nothing, in parts of its step; where these are some 25 us or shorter, joints about "
        "a thin, light body between heavier ones gain energy without bound. One or two `solver_iterations` or a longer step settle it",
        never_settles),
]


def row(scene, runs, what, amount):
    """The row that a difference falls under."""
    fits = (one for one in ROWS if scene["family"] in one.families and what in one.whats and amount <= one.most)
    return next((one for one in fits if one.when(scene, runs)), None)
