"""All families of scenes by name; a seed and a family make one scene."""

import contacts
import drawn
import mechanisms
import scene as scenes

FAMILIES = {
    "tree": mechanisms.tree, "friction": mechanisms.friction, "stop": mechanisms.stop, "gear": mechanisms.gear,
    "pins": mechanisms.pins, "loop": mechanisms.loop, "floating": mechanisms.floating, "throw": contacts.throw,
    "slide": contacts.slide, "roll": contacts.roll, "belt": contacts.belt, "table": contacts.table, "stack": contacts.stack,
    "pusher": contacts.pusher, "land": contacts.land,
}


def made(family, seed):
    scene = scenes.empty(family, seed)
    FAMILIES[family](drawn.Draw(seed, family), scene)
    return scene


def of_seed(seed):
    """The family whose turn it is."""
    return list(FAMILIES)[seed % len(FAMILIES)]
