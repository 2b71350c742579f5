"""Differences that are known: a row each, with its reason. A row is not a looser bound: what is beyond it is a finding."""


class Row:
    def __init__(self, name, families, whats, most, reason):
        self.name, self.families, self.whats, self.most, self.reason = name, families, whats, most, reason


ROWS = [
    Row("friction turned", ["slide", "belt"], ["law", "friction"], 0.05,
        "the engine's friction at a sliding contact is not exactly against the velocity, as a contact's mass differs by direction: "
        "a box that slides at an angle to its edges goes off its way by up to 2 % of what friction takes"),
    Row("rolling on an edge", ["roll"], ["law", "friction", "sinking"], 0.02,
        "the engine keeps the contact points of cylinders and capsules for up to 1 mm or 1 degree, so that weight turns them"),
    Row("slipping on a turntable", ["table"], ["apart"], 0.2,
        "rigid bodies leave open how four corners share a weight, and what slips and turns goes by it; the engine's turned friction, "
        "too"),
]


def row(scene, what, amount):
    """The row that a difference falls under."""
    return next((one for one in ROWS if scene["family"] in one.families and what in one.whats and amount <= one.most), None)
