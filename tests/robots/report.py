"""All files of a folder: progress, what is found, and the table at the end."""

import collections
import multiprocessing
import sys
import time

import found
import judge
import theirs

GOOD = [judge.LOADS, judge.WITH_DENSITY]
APART = [theirs.FRAGMENT, theirs.INCOMPLETE, theirs.WANTS, theirs.REFUSED]


def compared(given, program, folder):
    files = list(found.files(folder))
    by_publisher, parts = found.packages(folder), found.included(files)
    files = [file for file in files if given.only in str(file.path)]
    if not files:
        print(f"tests/robots/compare: {folder} has no such file with a <robot> or a <mujoco>", file=sys.stderr)
        return 3
    results, began = [], time.monotonic()
    work = [(given, program, folder, file, found.packages_for(by_publisher, file.publisher), parts) for file in files]
    # xacro keeps what it has read in its module, so that no process reads two files
    with multiprocessing.get_context("fork").Pool(given.jobs, maxtasksperchild=1) as pool:
        for number, result in enumerate(pool.imap(judge.one, work, chunksize=1), start=1):
            results.append(result)
            show(result, folder, given.all)
            if number % 50 == 0 or number == len(files):
                print(f"{number} of {len(files)} files, {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)
    table(results)
    harness = sum(result.kind == judge.HARNESS for result in results)
    bad = sum(result.kind == judge.OURS or bool(result.apart) for result in results)
    return 3 if harness else 1 if bad else 0


def show(result, folder, is_all):
    at_fault = result.kind in (judge.OURS, judge.HARNESS) or result.apart
    if not (is_all or at_fault):
        return
    text = result.apart or result.text
    if result.is_equal:
        text = f"{result.joints} joints: mass matrix {result.mass:.1e}, gravity {result.gravity:.1e}"
    kind = "apart" if result.apart else result.kind
    print(f"{kind}: {result.file.named(folder)}: {text}", flush=True)


def table(results):
    rows = collections.defaultdict(list)
    for result in results:
        rows[result.file.publisher].append(result)
    print("\n| publisher | files | " + " | ".join(APART) + " | whole | load | of these with a density | compared | equal |")
    print("|---|" + "---|" * (len(APART) + 6))
    for publisher, own in [*sorted(rows.items()), ("all", results)]:
        kinds = collections.Counter(result.kind for result in own)
        good = sum(kinds[kind] for kind in GOOD)
        cells = [len(own), *(kinds[kind] for kind in APART), good + kinds[judge.OURS], good, kinds[judge.WITH_DENSITY],
                 sum(result.is_compared for result in own), sum(result.is_equal for result in own)]
        print(f"| {publisher} | " + " | ".join(map(str, cells)) + " |")
    whole = sum(result.kind in [*GOOD, judge.OURS] for result in results)
    good = sum(result.kind in GOOD for result in results)
    worst = max((max(result.mass, result.gravity) for result in results if result.is_equal), default=0.0)
    share = f", {100 * good / whole:.1f} %" if whole else ""
    print(f"\n{good} of {whole} whole files load{share}; of those that are equal, the greatest difference is {worst:.1e}")
