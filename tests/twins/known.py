"""Differences that are known: a row each, with its reason. A row is not a looser bound: what is beyond it is a finding."""


class Row:
    def __init__(self, name, families, whats, most, reason):
        self.name, self.families, self.whats, self.most, self.reason = name, families, whats, most, reason


ROWS = []


def row(scene, what, amount):
    """The row that a difference falls under."""
    return next((one for one in ROWS if scene["family"] in one.families and what in one.whats and amount <= one.most), None)
