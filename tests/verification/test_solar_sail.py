"""The solar sail: geometry, balances and closed forms, on a coarse sail and on the whole one."""

from __future__ import annotations

import numpy as np
import pliant as pl
import pytest

RATE = 20 * 2 * np.pi / 60
COARSE = {"cell": 0.1, "base_cells": 8, "rows": 4, "arc_cells": 2}
# A film a thousand times softer: strained by less than a hundredth, resolved by steps of milliseconds.
SOFT = {"youngs_modulus": 2.5e6}


def coarse(**options):
    """A sail of the rig's size with cells twice as large."""
    return pl.scenes.solar_sail("rig", **COARSE, **options)


def test_counts_and_sizes_of_the_rig(record):
    scene = pl.scenes.solar_sail()
    model, sizes = scene.model, pl.scenes.SailSizes()
    x, _, quads, triangles = sizes.grid()
    assert (len(x), len(quads), len(triangles)) == (225, 184, 16)
    # 900 nodes with three coordinates and the hub; 36 pairs of nodes, hinge, motor, rigidity of the hub.
    assert (model.dof, model.constraints) == (2700 + 12, 108 + 5 + 1 + 6)
    reference = {"area": 1.92, "half": 0.8, "hub_radius": 0.25464790894703254, "inertia": 0.138752}
    for name, value in reference.items():
        # Rounding.
        assert record(f"sail rig, {name}", getattr(sizes, name), value, 1e-12 * value, source="closed form")
    assert np.isclose(sizes.inertia * RATE, 0.29060150924726064, rtol=1e-12)
    assert np.isclose(sizes.tension(0.4), 0.20016435023578202, rtol=1e-12)
    assert np.isclose(sizes.tension(0.6), 0.17524908223658756, rtol=1e-12)


def test_counts_and_sizes_of_ikaros(record):
    scene = pl.scenes.solar_sail("ikaros")
    sizes = pl.scenes.SailSizes.named("ikaros")
    x, _, quads, triangles = sizes.grid()
    assert (len(x), len(quads), len(triangles)) == (1232, 1134, 54)
    assert scene.model.constraints == 3 * 112 + 5 + 6
    stepper = pl.Stepper(scene.model, step=1e-6)
    cross = float(stepper.angular_momentum[2]) / sizes.spin
    flat = sizes.inertia + sizes.hub_inertia
    # 25 rpm stowed (moment of inertia 101.3745 kg m^2, from the craft's sizes) keep their angular momentum.
    stowed = 101.3745 * 25
    for name, inertia, flight, part in (("cross", cross, 7.4, 0.1), ("open", flat, 2.5, 0.35)):
        # What the craft's thrusters gave and took between is not in it.
        assert record(
            f"IKAROS, {name}", stowed / inertia, flight, part * flight, unit="rpm", source="telemetry"
        )


@pytest.mark.parametrize("name", ["rig", "ikaros"])
def test_the_fold_is_free_of_strain(name):
    sizes = pl.scenes.SailSizes.named(name)
    _, _, quads, triangles = sizes.grid()
    crosses = [sizes.cross(j) for j in range(4)]
    for j in range(4):
        flat, cross = sizes.flat(j), crosses[j]
        for faces, a, b in [(quads, 0, 1), (quads, 1, 2), (quads, 0, 2), (quads, 1, 3)] + [
            (triangles, k, (k + 1) % 3) for k in range(3)
        ]:
            before, after = (np.linalg.norm(p[faces[:, a]] - p[faces[:, b]], axis=1) for p in (flat, cross))
            # Rounding of places a hundred cells away.
            assert np.allclose(before, after, rtol=1e-12)
    # Neighbours' edges lie on each other.
    x, y, _, _ = sizes.grid()
    right, left = x == sizes.base_cells // 2 + y, x == -(sizes.base_cells // 2 + y)
    for places in (crosses, [sizes.flat(j) for j in range(4)]):
        for j in range(4):
            assert np.abs(places[j][right] - places[(j + 1) % 4][left]).max() < 1e-14 * sizes.half * 8


def test_release_balances(record):
    """Torque = rate of angular momentum; no torque while the tethers hang; symmetric; energy."""
    scene = coarse(**SOFT, duration=0.5, step=2.5e-3, output_every=4)
    result = scene.simulate(tolerance=1e-13)
    found = scene.measure(result)
    # What Newton's iteration leaves over.
    assert record("sail released, torque", found["momentum balance"], 0.0, 1e-8, source="dL/dt = torque")
    assert record("sail released, momentum across", found["momentum across"], 0.0, 1e-5, source="conserved")
    hanging = found["tether tension"].max(axis=1) == 0.0
    assert 4 <= hanging.sum() < len(hanging)
    most = np.abs(found["torque"]).max()
    assert most > 0.0
    # The motor sees nothing of the sail before but what the hub's equations leave over.
    early = np.abs(found["torque"][hanging]).max() / most
    assert record("sail released, torque before tethers", early, 0.0, 2e-6, source="none")
    start = found["angular momentum"][0]
    drift = np.abs(found["angular momentum"][hanging] / start - 1).max()
    # Second order of the step, here 2.5 ms: the scheme balances torques, it does not sum up moments exactly.
    assert record("sail released, angular momentum", drift, 0.0, 1e-3, source="conserved")
    assert record("sail released, energy", found["work balance"], 0.0, 2e-2, source="conserved")


def test_a_free_hub_keeps_the_angular_momentum(record):
    scene = coarse(**SOFT, driven=False, duration=0.5, step=2.5e-3, output_every=4)
    result = scene.simulate()
    moment = result.angular_momentum[:, 2]
    # Second order of the step.
    assert record("sail on a free hub, angular momentum", np.ptp(moment) / moment[0], 0.0, 2e-5)
    # The sail takes it from the hub.
    assert result.joint(scene.model["shaft"]).velocity[-1] < 0.9995 * RATE


@pytest.mark.parametrize("wrinkling", [1e-4, False])
def test_steady_spin_of_the_flat_sail(record, wrinkling):
    """Cuts, tips and angular momentum in steady spin, whatever the film does."""
    # More damping lets the corners' masses, on springs of film, come to rest within 0.06 s.
    options = {"start": "flat", "retardation_time": 3e-3, "duration": 0.06, "youngs_modulus": 2.5e9}
    scene = coarse(wrinkling=wrinkling, **options)
    result = scene.simulate()
    found = scene.measure(result)
    film = "elastic film" if wrinkling is False else "film"
    # Strains of 1e-5 widen the sail.
    assert record(f"spinning {film}, force at its base", found["tension at the base"], 0.20016, 1e-4, "N")
    assert record(f"spinning {film}, force midway", found["tension at the middle"], 0.17525, 1e-4, "N")
    moment = found["angular momentum at the end"]
    assert record(f"spinning {film}, angular momentum", moment, 0.29060, 1e-5, "kg m^2/s")
    corner = result.model["petal1"].node(len(pl.scenes.SailSizes(**COARSE).grid()[0]) - 1)
    pull = 0.02 * np.linalg.norm(result.track(corner).acceleration[-1])
    assert record(f"spinning {film}, tip force", pull, 0.09925, 1e-4, "N", source="m omega^2 R")


SURFACES = {
    "bicubic": ("shell", {"element": "bicubic"}),
    "cylindrical": ("shell", {"element": "cylindrical"}),
    "plate": ("shell", {"element": "plate"}),
    "triangle": ("shell", {"element": "triangle"}),
    "membrane": ("membrane", {"wrinkling": False}),
    "film": ("membrane", {"wrinkling": 1e-4}),
}


@pytest.mark.parametrize("kind", SURFACES)
def test_rigid_rotation_strains_nothing(kind):
    film = pl.SaintVenantKirchhoff(youngs_modulus=2.5e9, poisson_ratio=0.34, density=1420.0)
    mesh = pl.Mesh.rectangle(0.4, 0.3, divisions=(3, 2))
    about, angle = np.array([1.0, 2.0, -0.5]), 2.3
    about /= np.linalg.norm(about)
    from scipy.spatial.transform import Rotation

    turned = Rotation.from_rotvec(angle * about).apply(mesh.points - [0.1, 0.2, 0.0])
    model = pl.Model()
    family, options = SURFACES[kind]
    add = model.add_shell if family == "shell" else model.add_membrane
    add(mesh, thickness=25e-6, material=film, initial=turned, **options)
    energy = float(pl.Stepper(model, step=1e-9).energy.elastic)
    # Rounding of strains: E h A (1e-16)^2 is 1e-27 J, of curvature over the thickness less.
    assert energy < 1e-24


def test_tether_and_tip_mass_swing_about_the_hub(record):
    """A taut line l on a hub of radius rho: omega sqrt(rho/l) in the plane, omega sqrt(1 + rho/l) across."""
    rho, length, mass = 0.2546, 0.6, 0.02
    model = pl.Model()
    hub = model.add_rigid_body(mass=1.0, shape=pl.Cylinder(rho, 0.1), angular_velocity=(0, 0, RATE))
    shaft = model.hinge(hub.center)
    model.drive(shaft, rate=RATE)
    # The tether's stretch is a millionth of its length.
    stretch = mass * RATE**2 * (rho + length) / 1e5
    nudge = np.array([0.0, 2e-4, 3e-4])
    out = rho + length + stretch
    tip = model.add_point_mass(mass, at=(out, 0, 0), velocity=RATE * np.array([0, out, 0]) + nudge)
    line = model.add_tendon([hub.at((rho, 0, 0)), tip], length=length, stiffness=1e5 * length)
    result = pl.simulate(model, duration=12.0, step=4e-3)
    place = result.track(tip).position
    angle = result.joint(shaft).position
    across = place[:, 1] * np.cos(angle) - place[:, 0] * np.sin(angle)
    assert result.tendon(line).tension.min() > 0.0
    for name, value, exact in (
        ("in the plane", across, 1.3643072534677458),
        ("out of the plane", place[:, 2], 2.499564987511488),
    ):
        k = np.flatnonzero(np.diff(np.sign(value)))
        zeros = result.time[k] - value[k] * np.diff(result.time)[k] / np.diff(value)[k]
        found = np.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0])
        # Second order of the step, and zeros between outputs.
        assert record(f"tether and tip, {name}", found, exact, 2e-4 * exact, "rad/s", source="closed form")


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_release_of_the_whole_rig(record):
    """Against particles joined by strings of a hundredth of the film's stiffness, from the scene's notes."""
    scene = pl.scenes.solar_sail()
    result = scene.simulate()
    found = scene.measure(result)
    assert not scene.failures(found), scene.report(found)
    radius = found["tip radius"].mean(axis=1)
    lag = np.degrees(found["tip lag"].mean(axis=1))
    for time, tip, angle in (
        (0.1, 0.8726, 0.2),
        (0.25, 0.9553, 2.3),
        (0.35, 1.0157, 5.3),
        (0.5, 1.0950, 11.7),
    ):
        k = int(np.argmin(np.abs(found["time"] - time)))
        # Inertia decides up to 0.3 s; then strings between particles and a film differ by what they do to it.
        tolerance = (0.02 if time < 0.3 else 0.035) * tip
        assert record(f"sail rig, tip radius at {time:g} s", radius[k], tip, tolerance, "m", "particles")
        assert record(f"sail rig, tip lag at {time:g} s", lag[k], angle, 1.5, "degrees", "particles")
    assert record("sail rig, torque", found["momentum balance"], 0.0, 1e-8, source="dL/dt = torque")


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize(("rate", "step"), [(RATE, 1e-3), (20.0, 2.5e-4)])
def test_steady_spin_of_the_whole_rig(record, rate, step):
    """The closed form is that of a film that does not stretch: what the film's stiffness leaves goes as 1/E.

    The film widens by some strain when it is let go. Its tethers hardly hold it, so that it keeps its angular
    momentum, turns slower by twice the strain, and pulls less by three times the strain.
    """
    # Strains of a turning film change by some (omega h)^2 within a step, which damping answers to.
    options = {"start": "flat", "retardation_time": 3e-3, "duration": 0.06, "spin": rate, "step": step}
    found = []
    for youngs_modulus in (2.5e9, 1e10):
        scene = pl.scenes.solar_sail(youngs_modulus=youngs_modulus, **options)
        found.append(scene.measure(scene.simulate()))
    for place, value in (("base", 0.20016435023578202), ("middle", 0.17524908223658756)):
        value *= (rate / RATE) ** 2
        soft, stiff = (f[f"tension at the {place}"] for f in found)
        name = f"whole rig at {rate:.4g} rad/s, force at its {place}"
        widening = found[0]["tip radius"][-1].mean() / (np.sqrt(2) * 0.8) - 1
        # The strain at the tips stands for that of the whole film.
        assert abs(soft / value - 1) < max(1e-4, 4 * widening)
        limit = stiff + (stiff - soft) / 3
        assert record(f"{name}, E to infinity", limit, value, 1e-4 * value, "N", "closed form")


def test_a_tether_unwinds_from_its_hub(record):
    """A line with a mass at its end, wound on a driven hub: it turns twice as fast as the hub.

    For a line without mass that does not stretch l = rho w t, and the mass is at
    rho e_r(2 w t) - l e_t(2 w t), pulled by 4 m w^2 l. It starts on the hub with the hub's velocity.
    """
    mass, turn, radius = 0.2, 2.36, 1e-3
    around = 0.2546 + radius

    def wound(s):
        angle = turn + 0.5 - s / around
        return around * np.cos(angle), around * np.sin(angle), 0.0

    model = pl.Model()
    hub = model.add_rigid_body(mass=1.0, shape=pl.Cylinder(0.2546, 0.1), angular_velocity=(0, 0, RATE))
    model.drive(model.hinge(hub.center, axis=(0, 0, 1)), rate=RATE)
    tether = model.add_cable(
        pl.Curve(wound, length=around * (turn + 0.5)),
        elements=40,
        angular_velocity=(0, 0, RATE),
        **pl.scenes.scene.line(1e4, 1e-6, 2e-4, radius, 2e-4),
    )
    model.pin(tether.start, hub)
    model.add_point_mass(mass, at=tether.end)
    model.add_contact(tether, hub, stiffness=1e6)
    result = pl.simulate(model, duration=turn / RATE, step=2e-3)
    time = result.time
    length, angle = around * RATE * time, 2 * RATE * time
    out = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    along = np.stack([-np.sin(angle), np.cos(angle), 0 * angle], axis=1)
    exact = around * out - length[:, None] * along
    place = result.track(tether.end).position
    off = np.linalg.norm(place - exact, axis=1).max()
    # Strains of 2e-4 and a penetration of 1e-5 m let the mass lag: both are compliance, halved with it.
    assert record("tether unwinding, place of its end", off, 0.0, 2e-3, unit="m", source="closed form")
    pull = result.axial_force(tether)[:, -1]
    late = time > 0.5 * time[-1]
    share = pull[late].mean() / (4 * mass * RATE**2 * length[late].mean())
    # The line itself weighs a thousandth of the mass, and the lag is in the length.
    assert record("tether unwinding, tension over 4 m w^2 l", share, 1.0, 3e-3, source="closed form")
    # The direction of the straight part, from the last two nodes.
    nodes = result.positions(tether)[late]
    straight = nodes[:, -1] - nodes[:, -3]
    turned = np.unwrap(np.arctan2(straight[:, 1], straight[:, 0]))
    rate = np.polyfit(time[late], turned, 1)[0]
    assert record("tether unwinding, rate of the line over the hub's", rate / RATE, 2.0, 0.01)
