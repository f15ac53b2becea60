"""MuJoCo's side of contact.py: two ropes thrown across each other; in MuJoCo's own environment.

One JSON line a run on standard output. MuJoCo's `cable` composite: capsules joined by ball joints, bent
and twisted by its elasticity plugin. The ropes do not stretch, contact is between capsules, with a cone of
friction and no memory, and soft constraints stand for the stiffness of the contact. The low rope is held at
both ends by constraints. Only the steps are timed.
"""

import argparse
import json
import time

import mujoco
import numpy as np

RADIUS, YOUNGS_MODULUS, POISSON_RATIO, DENSITY, FRICTION = 5e-3, 1e7, 0.4, 1000.0, 0.5
RETARDATION = 1e-3  # [s]
VELOCITY = (0.3, 0.0, -1.0)

ROPE = """
<composite prefix="{name}_" type="cable" curve="{curve}" count="{count} 1 1" size="1"
           initial="{initial}" offset="{offset}">
  <plugin plugin="mujoco.elasticity.cable">
    <config key="bend" value="{youngs_modulus}"/>
    <config key="twist" value="{shear_modulus}"/>
    <config key="vmax" value="0"/>
  </plugin>
  <joint kind="main" damping="{damping}"/>
  <geom type="capsule" size="{radius}" density="{density}" friction="{friction} 0 0" condim="3"
        contype="{own}" conaffinity="{other}" solref="{solref}"/>
</composite>
"""


def model(elements, step, solref):
    """Build both ropes; each may touch the other only."""
    stiffness = YOUNGS_MODULUS * np.pi * RADIUS**4 / 4 * elements  # of a joint, EI/l
    common = {
        "count": elements + 1,
        "youngs_modulus": YOUNGS_MODULUS,
        "shear_modulus": YOUNGS_MODULUS / (2 + 2 * POISSON_RATIO),
        "damping": RETARDATION * stiffness,
        "radius": RADIUS,
        "density": DENSITY,
        "friction": FRICTION,
        "solref": solref,
    }
    low = ROPE.format(name="low", initial="ball", curve="s 0 0", offset="0 0 0", own=1, other=2, **common)
    place = {"curve": "0 s 0", "offset": "0.47 -0.52 0.05"}
    high = ROPE.format(name="high", initial="free", own=2, other=1, **place, **common)
    text = f"""
<mujoco>
  <extension><plugin plugin="mujoco.elasticity.cable"/></extension>
  <option timestep="{step}" gravity="0 0 -9.81" integrator="implicitfast" cone="elliptic"/>
  <size memory="64M"/>
  <worldbody>
    {low}
    {high}
  </worldbody>
  <equality><connect body1="low_B_last" anchor="{1 / elements} 0 0"/></equality>
</mujoco>"""
    return mujoco.MjModel.from_xml_string(text)


def run(elements, step, steps, solref):
    """Half a second; the least processor time of three runs."""
    this = model(elements, step, solref)
    best, report = np.inf, {}
    for _ in range(3):
        data = mujoco.MjData(this)
        first = this.body("high_B_first").dofadr[0]
        data.qvel[first : first + 3] = VELOCITY
        touching = deepest = iterations = 0.0
        mujoco.mj_forward(this, data)
        spent = 0.0
        for _ in range(steps):
            start = time.process_time()
            mujoco.mj_step(this, data)
            spent += time.process_time() - start
            iterations += float(data.solver_niter[0])
            if data.ncon:
                touching += 1
                deepest = max(deepest, -float(data.contact.dist.min()))
        best = min(best, spent)
        report = {
            "steps_touching": touching,
            "penetration_over_radius": deepest / RADIUS,
            "iterations": iterations / steps,
            "end_of_high_rope": data.body("high_B_last").xpos.tolist(),
        }
    return {"elements": elements, "step": step, "ms_a_step": 1e3 * best / steps, **report}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--elements", type=int, nargs="+", default=[20, 40, 80])
    parser.add_argument("--step", type=float, default=5e-4)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--solref", default="0.001 1", help="time constant and damping ratio of its contacts")
    given = parser.parse_args()
    print(json.dumps({"program": f"MuJoCo {mujoco.__version__}"}))
    for count in given.elements:
        print(json.dumps(run(count, given.step, given.steps, given.solref)), flush=True)
