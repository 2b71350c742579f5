"""Many scenes at once: progress, findings as they come, and the table at the end."""

import collections
import concurrent.futures
import sys
import time
import traceback

import families
import judge
import known
import minimise
import ours
import scene as scenes
import theirs

KINDS = [judge.EQUAL, judge.APART, judge.LOOSE, judge.LEFT_OUT, judge.KNOWN, judge.FINDING]


def names():
    return list(families.FAMILIES)


def listed():
    for name, make in families.FAMILIES.items():
        print(f"{name:<10}{make.__doc__.splitlines()[0]}")
    for row in known.ROWS:
        print(f"known: {row.name} ({', '.join(row.families)}): {row.reason}")
    return 0


class Done:
    """One scene: its verdict and, of a finding, the smallest scene."""

    def __init__(self, family, seed, verdict, smallest=None, tries=0):
        self.family, self.seed, self.verdict, self.smallest, self.tries = family, seed, verdict, smallest, tries


def one(program, family, seed, is_cut):
    """Runs in a process of its own; what breaks the harness is reported as such."""
    try:
        scene = families.made(family, seed)
        verdict = judge.verdict(program, scene)
        if verdict.kind != judge.FINDING or not is_cut:
            return Done(family, seed, verdict, scene)
        smallest, last, tries = minimise.smallest(program, scene, verdict.what)
        return Done(family, seed, last or verdict, smallest, tries)
    except Exception:
        return Done(family, seed, judge.Verdict(judge.LEFT_OUT, "harness", traceback.format_exc()))


def compared(given, program):
    if not judge.canary(program):
        print("tests/twins/compare: a mass that is 1 % larger for MuJoCo is not found, so nothing would be", file=sys.stderr)
        return 3
    seeds = range(given.first, given.first + given.seeds)
    work = [(given.family or families.of_seed(seed), seed) for seed in seeds]
    counts = collections.defaultdict(collections.Counter)
    rows, harness, began, said = collections.Counter(), 0, time.monotonic(), 0.0
    with concurrent.futures.ProcessPoolExecutor(given.jobs) as pool:
        todo = [pool.submit(one, program, family, seed, not given.as_drawn) for family, seed in work]
        for number, future in enumerate(todo, start=1):
            done = future.result()
            counts[done.family][done.verdict.kind] += 1
            rows[done.verdict.row] += done.verdict.row is not None
            harness += done.verdict.what == "harness"
            show(done, given)
            if time.monotonic() - said > (0.5 if sys.stderr.isatty() else 20.0) or number == len(work):
                said = time.monotonic()
                progress(number, len(work), counts, said - began)
    table(counts)
    for row in known.ROWS:
        print(f"known: {row.name}: {rows[row.name]} scenes. {row.reason}")
    found = sum(count[judge.FINDING] for count in counts.values())
    print(f"\n{len(work)} scenes, {found} findings")
    return 3 if harness else 1 if found else 0


def progress(number, all_of_them, counts, seconds):
    found = sum(count[judge.FINDING] for count in counts.values())
    end = "\r" if sys.stderr.isatty() and number < all_of_them else "\n"
    print(f"{number} of {all_of_them} scenes, {found} findings, {seconds:.0f} s", end=end, file=sys.stderr, flush=True)


def show(done, given):
    kind = done.verdict.kind
    if kind == judge.FINDING:
        print(f"\nfinding: --family {done.family} --first {done.seed} --seeds 1: {done.verdict.text}")
        keep(done, given.keep)
        if not given.as_drawn:
            print(f"the smallest scene that differs so ({done.tries} tries):\n\n{ours.machine(done.smallest)}", flush=True)
    elif given.all or done.verdict.what == "harness":
        print(f"{kind}: {done.family} {done.seed}: {done.verdict.text}", flush=True)


def keep(done, folder):
    place = folder / f"{done.family}-{done.seed}"
    place.mkdir(parents=True, exist_ok=True)
    (place / "plant.toml").write_text(ours.plant(done.smallest))
    (place / "scenario.toml").write_text(ours.scenario(done.smallest, done.smallest["step_us"]))
    (place / "mujoco.xml").write_text(theirs.mjcf(done.smallest, judge.THEIRS_US))
    (place / "scene.json").write_text(scenes.text(done.smallest))
    print(f"kept in {place}")


def table(counts):
    print("\n| family | scenes | " + " | ".join(KINDS) + " |")
    print("|---|---|" + "---|" * len(KINDS))
    total = collections.Counter()
    for family in names():
        if family in counts:
            total.update(counts[family])
            print(f"| {family} | {sum(counts[family].values())} | " + " | ".join(str(counts[family][kind]) for kind in KINDS) + " |")
    print(f"| all | {sum(total.values())} | " + " | ".join(str(total[kind]) for kind in KINDS) + " |\n")
