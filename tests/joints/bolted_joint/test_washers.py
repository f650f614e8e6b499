"""Washers against axisymmetric finite elements of a plate and a solid washer."""

import numpy as np
import pytest
import skfem
from jointfmu_tools.inputs.drawing import vdi2230
from jointfmu_tools.inputs.drawing.tables import find_washer, read_threads

pytestmark = pytest.mark.slow  # solves finite elements

HOLE, RADIUS, THICKNESS, E_PLATE, NU = 17.5e-3, 40e-3, 20e-3, 210e9, 0.3
"""Plate of an M16 bolt: hole diameter, outer radius, thickness [m], Young's modulus [Pa], Poisson's ratio."""


def compliance(load_diameter, washer=None):
    """Compliance [m/N] of a plate with a bonded washer under uniform pressure, on a frictionless rigid plane
    from which it may separate. The pressure acts from the hole to `load_diameter` [m]; the deflection is the
    mean over this area."""
    outer, height = (0.5 * washer.outer_diameter, washer.thickness) if washer else (0.0, 0.0)
    r = [np.linspace(0.5 * HOLE, 20e-3, 23), np.linspace(20e-3, RADIUS, 8), [0.5 * load_diameter, outer]]
    z = [np.linspace(0.0, THICKNESS, 12), np.linspace(THICKNESS - 4e-3, THICKNESS, 7)]
    z += [np.linspace(THICKNESS, THICKNESS + height, 5)] if washer else []
    r, z = (np.unique(np.round(np.concatenate(each), 8)) for each in (r, z))
    r = r[r > 0.0]
    mesh = skfem.MeshQuad.init_tensor(r, z)
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    mesh = mesh.restrict(np.flatnonzero((y < THICKNESS) | (x < outer)))
    element = skfem.ElementVector(skfem.ElementQuad2())
    basis = skfem.Basis(mesh, element, intorder=5)

    def strains(u, r):
        du = u.grad
        return du[0, 0], du[1, 1], u[0] / r, du[0, 1] + du[1, 0]

    @skfem.BilinearForm
    def energy(u, v, w):
        r, z = w.x
        E = np.where(z > THICKNESS, vdi2230.E_WASHER, E_PLATE)
        lam, G = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), 0.5 * E / (1.0 + NU)
        a, b = strains(u, r), strains(v, r)
        normal = sum(2.0 * G * p * q for p, q in zip(a[:3], b[:3], strict=True))
        return 2.0 * np.pi * r * (lam * sum(a[:3]) * sum(b[:3]) + normal + G * a[3] * b[3])

    loaded = mesh.facets_satisfying(
        lambda x: (np.abs(x[1] - THICKNESS - height) < 1e-9) & (x[0] < 0.5 * load_diameter)
    )
    area = 0.25 * np.pi * (load_diameter**2 - HOLE**2)
    load = skfem.LinearForm(lambda v, w: -2.0 * np.pi * w.x[0] * v[1] / area).assemble(
        skfem.FacetBasis(mesh, element, facets=loaded, intorder=5)
    )
    stiffness = energy.assemble(basis)
    base = basis.get_dofs(lambda x: np.abs(x[1]) < 1e-9).all("u^2")
    closed = np.ones(base.size, dtype=bool)
    for _ in range(20):
        u = skfem.solve(*skfem.condense(stiffness, load, D=base[closed]))
        force = (stiffness @ u - load)[base]
        now = np.where(closed, force > 0.0, u[base] < 0.0)
        if np.array_equal(now, closed):
            return float(load @ u)
        closed = now
    raise AssertionError("the contact does not settle")


def test_the_cone_below_a_washer_is_nearer_than_the_face_of_the_surface_pressure():
    """Half of a joint of 2 x 20 mm: the plate loaded over the cone diameter below the washer, in series with
    the washer, against a plate with its washer. The other diameter is d_Wa = d_w + 1.6 h_S, which VDI 2230
    uses for the surface pressure."""
    thread = read_threads()["M16"]
    washer, d_w = find_washer(thread), thread.hexagon_bearing_diameter
    slope = vdi2230.cone_slope(2.0 * (THICKNESS + washer.thickness), d_w, 2.0 * RADIUS, is_tapped=False)
    own = vdi2230.washer_compliance(d_w, washer, slope)
    solid = compliance(d_w, washer)
    cone = compliance(vdi2230.washer_cone_diameter(d_w, washer, slope)) + own
    wide = compliance(d_w + 1.6 * washer.thickness) + own
    assert solid / cone == pytest.approx(1.09, abs=0.015)
    assert solid / wide == pytest.approx(1.19, abs=0.015)
