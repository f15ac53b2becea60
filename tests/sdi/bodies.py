"""The bodies of the independent reference, reference.json: how each was computed is noted there."""

import json
from pathlib import Path

import pliant as pl

REFERENCE = json.loads((Path(__file__).parent / "reference.json").read_text())
CASES = {case["name"]: case for case in REFERENCE["bodies"]}
LENGTH, HEIGHT, WIDTH, MODULUS = 0.1, 0.01, 0.01, 1e6


def body_of(case):
    """Make the body of a case."""
    p = case["params"]
    if "xs" in p:
        rows = [(x, p["w"], p["hm"]) for x in p["xs"]]
        return pl.sdi.notches(p["L"], p["h0"], p["b"], rows, p["E"])
    if "w" in p:
        return pl.sdi.cosine_notch(p["L"], p["h0"], p["b"], p["w"], p["hm"], p["E"], center=p["xc"])
    if "d0" in p:
        return pl.sdi.exponential(p["L"], p["d0"], p["d1"], p["E"])
    if "h1" in p:
        return pl.sdi.cosine_taper(p["L"], p["h0"], p["h1"], p["b"], p["E"])
    return pl.sdi.uniform(p["L"], p["h0"], p["b"], p["E"])


def loads_of(case):
    """Loads of a case as arguments of ``bend``."""
    return {"moment": case["M"], "force": case["F"]}


def notched(w, left, **options):
    """Strip of the studies with a cosine notch."""
    return pl.sdi.cosine_notch(LENGTH, HEIGHT, WIDTH, w, left, MODULUS, **options)
