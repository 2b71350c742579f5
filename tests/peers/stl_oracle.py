"""Robustness by rtamt: reads lines of JSON {formula, a, b} and writes the value at the first sample.

Samples are one unit of time apart. Infinite values are written as null with their sign.
"""

import json
import sys

import rtamt

for line in sys.stdin:
    case = json.loads(line)
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in ("a", "b"):
        spec.declare_var(name, "float")
    spec.declare_var("out", "float")
    spec.spec = "out = " + case["formula"]
    spec.parse()
    samples = {"time": list(range(len(case["a"]))), "a": case["a"], "b": case["b"]}
    print(json.dumps(str(float(spec.evaluate(samples)[0][1]))))
