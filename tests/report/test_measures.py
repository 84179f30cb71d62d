"""Figures of cases on rows made by a formula, whose figure is known."""

import tempfile
import unittest
from pathlib import Path

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import cases_contact
import cases_coupled
import cases_drop
import cases_experiment
import cases_fluid
import cases_loads
import cases_spin
import cases_surface
import cases_waves
from case import Outcome, Variant
from metrics import NoFigure
from references import read_table

TREE = Path(__file__).resolve().parents[2]


class Made(Outcome):
    """A run that never was: times and columns."""

    def __init__(self, t: np.ndarray, columns: dict[str, np.ndarray], references: list[Path] | None = None):
        self.record, self.h, self.variant, self._references = {}, 1.0, Variant(), references or []
        self._columns, self._times = columns, dict.fromkeys(columns, t)


class Measures(unittest.TestCase):
    def test_a_period_between_troughs_does_not_mind_a_middle_that_sinks(self):
        t = np.linspace(0, 15, 3001)
        run = Made(t, {})
        run.variant = Variant("", {}, {"ratio": 100})
        exact = cases_waves.exact_frequency(run)
        for sinks in (0.0, 1e-4):
            middle = 1.099 - sinks * (t > 6.2)  # at once, near the crest between the troughs
            run._columns, run._times = {"piston.z": middle + 1e-3 * np.cos(2 * np.pi * exact * t)}, {"piston.z": t}
            self.assertAlmostEqual(cases_waves.frequency_by_troughs(run) / exact, 1, delta=1e-5)
        self.assertGreater(abs(cases_waves.piston_frequency(run) / exact - 1), 1e-3)

    def test_the_level_that_fits_best_is_found_between_that_of_the_start_and_that_of_the_end(self):
        references = [TREE / "tests/validation/reference"]
        table = read_table(cases_waves.HEAVE, references)
        lift = 0.0254
        middle = cases_waves.DEPTH + 0.5 * (cases_waves.rest(lift, 2) - cases_waves.DEPTH)
        height = middle + (cases_waves.DEPTH + lift - middle) * table["y_over_y0"]
        run = Made(table["t_star"] * np.sqrt(cases_waves.RADIUS / 9.81), {"body.z": height}, references)
        run.variant = Variant("", {}, {"lift": lift, "tank": 2})
        self.assertLess(cases_waves.heave_error_at_best(run), 1e-12)
        self.assertGreater(cases_waves.heave_error(run), 0.01)

    def test_levels_that_no_longer_swing_are_compared_at_the_end(self):
        t = np.linspace(0, 4, 401)
        run = Made(t, {"left": np.where(t < 3, 9.0, 0.73), "right": np.full_like(t, 0.7)})
        run.h = 0.02
        self.assertAlmostEqual(cases_surface.still_apart(run), 1.5)

    def test_the_largest_pressure_on_a_face_is_the_top_of_its_profile_not_a_single_row(self):
        t = np.linspace(1e-4, 0.02, 200)
        columns = {f"p{z}": 12500 * np.where(np.floor(z / 500 / t) == 13, 8.0, 5.0) for z in cases_waves.FACE}
        columns["p100"][150] *= 3
        self.assertAlmostEqual(cases_waves.face_pressure(Made(t, columns)), 8.0, delta=0.3)

    def test_error_of_velocity_is_a_mean_over_all_particles_nearest_to_one_second(self):
        with tempfile.TemporaryDirectory() as folder:
            rows = ((0.9, 5.0), (1.01, 0.1), (1.2, 7.0))  # of time, and what is too much in vx
            sets = [f'<DataSet timestep="{t}" part="0" file="p{k}.vtp"/>' for k, (t, _) in enumerate(rows)]
            Path(folder, "p.pvd").write_text(f"<VTKFile type='Collection'><Collection>{''.join(sets)}</Collection></VTKFile>")
            for k, (t, more) in enumerate(rows):
                x = np.array([[0.0, 0, 0.25], [0.25, 0, 0]])
                fade = np.exp(-0.08 * np.pi**2 * t)
                v = np.array([[-fade + more, 0, 0], [0, 0, fade]])
                data, points, velocity = vtkPolyData(), vtkPoints(), numpy_to_vtk(v.astype("f4"))
                points.SetData(numpy_to_vtk(x.astype("f4")))
                velocity.SetName("velocity")
                data.SetPoints(points)
                data.GetPointData().AddArray(velocity)
                writer = vtkXMLPolyDataWriter()
                writer.SetInputData(data)
                writer.SetFileName(str(Path(folder, f"p{k}.vtp")))
                writer.Write()
            run = Made(np.array([0.0]), {})
            run.folder = Path(folder)
            exact = 0.1 / 4 / np.exp(-0.08 * np.pi**2 * 1.01)
            self.assertAlmostEqual(cases_fluid.vortex_error(run), exact, places=6)

    def test_water_beside_the_round_foot_of_the_gate_has_no_moment(self):
        lines = (TREE / "scenes/report/gate.obj").read_text().splitlines()
        points = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
        foot = points[points[:, 1] < 0][:17, [0, 2]]  # the half circle, from the wet side to the dry one
        self.assertEqual([foot[0].tolist(), foot[-1].tolist()], [[-0.05, 0], [0.05, 0]])
        centre, force, torque = np.array([0.02, 0.3]), np.zeros(2), 0.0
        heights = (np.arange(1000) + 0.5) / 2000
        steps = [(np.array([-0.05, z]), np.array([9810 * (0.5 - z) / 2000, 0])) for z in heights]
        for k, (a, b) in enumerate(zip(foot, foot[1:])):
            normal = np.array([a[1] - b[1], b[0] - a[0]])  # into the gate, as long as the piece
            steps.append(((a + b) / 2, 4905 * (1 - k / 16) ** 2 * normal))
        for at, push in steps:
            force += push
            torque += (at - centre)[1] * push[0] - (at - centre)[0] * push[1]
        values = {"fx": force[0], "fz": force[1], "ty": torque, "x": 0.65 + centre[0], "z": centre[1]}
        run = Made(np.array([1.0]), {f"gate.{name}": np.array([value]) for name, value in values.items()})
        self.assertAlmostEqual(float(cases_waves.moment(run)[0]), 1000 * 9.81 * 0.5**3 / 6, delta=1e-3)

    def test_a_sphere_comes_to_roll_where_its_slip_ends(self):
        t = np.linspace(0, 1, 101)
        v = np.maximum(2 - 3.4335 * t, 0)  # 7/2 mu g
        run = Made(t, {"ball.vx": v + 1, "ball.wy": np.full(101, 10.0)})
        self.assertAlmostEqual(cases_contact.rolls_from(run), 2 / 3.4335, places=9)
        self.assertRaises(NoFigure, cases_contact.rolls_from, Made(t, {"ball.vx": 2 - t, "ball.wy": 0 * t}))

    def test_a_ball_rests_from_the_first_row_that_stays_still(self):
        t = np.linspace(0, 1, 101)
        run = Made(t, {"ball.vz": np.where((t < 0.3) | (np.abs(t - 0.5) < 1e-9), 1.0, 1e-4)})
        self.assertAlmostEqual(cases_contact.rests_from(run), 0.51, places=9)

    def test_orientation_of_a_fast_sphere(self):
        t = np.linspace(0, 1, 11)
        half = 5000 * t + 0.05 * t  # 0.1 rad too far at the end
        parts = {"w": np.cos(half), "x": 0.6 * np.sin(half), "y": 0.8 * np.sin(half), "z": 0 * t}
        run = Made(t, {f"body.q{name}": value for name, value in parts.items()})
        run.variant = Variant("", {}, {"sphere": True})
        self.assertAlmostEqual(cases_spin.sphere_turned(run), 0.1, places=9)

    def test_what_contacts_gave_is_what_the_fluid_did_not_give(self):
        t, masses = np.array([0.0, 1]), cases_coupled.SOLIDS
        columns = {f"{n}.v{axis}": np.array([0.5, 0.5]) for n in masses for axis in "xyz"}
        columns["a.vx"][1] -= 3 / masses["a"]
        columns["c.vx"][1] += 5 / masses["c"]
        run = Made(t, columns)
        run.record = {"ledger": {"per_body_N_s": {"a": [0, 0, 0], "b": [0, 0, 0], "c": [2, 0, 0]}}}
        self.assertAlmostEqual(cases_coupled.contacts_balance(run), 0, places=12)
        self.assertEqual(cases_coupled.never_hit(run, "c", masses), 0)
        self.assertEqual(cases_coupled.never_hit(run, "b", masses), 1)
        run.record["ledger"]["per_body_N_s"]["c"][0] = 3
        self.assertAlmostEqual(cases_coupled.contacts_balance(run), 1 / 5, places=12)

    def test_angular_momentum_of_a_drop_is_the_same_about_a_point_that_bodies_pass(self):
        # Bodies that fly straight on keep theirs; that of the fluid grows by a thousandth of all.
        t = np.linspace(0, 1, 11)
        columns = {"motion.ly": 400 + t * 0}
        for n, m in cases_drop.MASSES.items():
            columns |= {f"{n}.x": 0.1 + 0.5 * t, f"{n}.z": 0.2 - 0.3 * t, f"{n}.vx": 0.5 + 0 * t, f"{n}.vz": -0.3 + 0 * t}
            columns[f"{n}.wy"] = 2 + 0 * t
        run = Made(t, columns)
        np.testing.assert_allclose(cases_drop.turned(run), 0, atol=1e-12)
        box = cases_drop.angular_momentum(run)[1][0]  # y of r x v is z vx - x vz
        self.assertAlmostEqual(box, 45 * (0.2 * 0.5 + 0.1 * 0.3) + 45 * 0.09 / 6 * 2, places=9)
        size = sum(part[0] for part in cases_drop.angular_momentum(run))
        columns["motion.ly"][-1] += 1e-3 * size
        self.assertAlmostEqual(cases_drop.turned(run)[-1], 1e-3, places=9)

    def test_a_rate_of_going_round_and_a_radius(self):
        t = np.linspace(0, 10, 501)
        r = 0.25 + 0.001 * t / 10
        run = Made(t, {"disc.x": r * np.cos(1.02 * t), "disc.z": -r * np.sin(1.02 * t)})  # about y, z up
        self.assertAlmostEqual(cases_coupled.round_about(run), 1.02, places=9)
        self.assertAlmostEqual(cases_coupled.radius_drift(run), 0.001, places=9)

    def test_when_a_place_is_first_reached(self):
        t = np.array([0.0, 1, 2, 3])
        self.assertAlmostEqual(cases_experiment.first_at(t, np.array([1.0, 2, 0, 4]), 1.5), 0.5)
        self.assertRaises(ValueError, cases_experiment.first_at, t, np.zeros(4), 1.5)

    def test_time_before_a_pillar_counts_from_the_first_water(self):
        t = np.array([0.0, 0.1, 0.2, 0.3])
        at, v = cases_loads.bore(Made(t, {"bore.vx": np.array([0, 0, 2.0, 1.5])}))
        np.testing.assert_allclose(at, t - 0.2)
        self.assertEqual(v[at >= 0].tolist(), [2.0, 1.5])

    def test_a_centre_of_mass_counts_from_its_own_start(self):
        t = np.linspace(0, 0.5, 51)
        way = {f"{n}.x": 0.1 * k + 0.26 * 0.4 * t for k, n in enumerate(cases_contact.CYLINDERS)}
        with tempfile.TemporaryDirectory() as folder:
            table = Path(folder) / cases_contact.CENTRE.format("x")
            table.write_text("t_s,x_m\n-0.001,0.5\n0.25,0.6\n0.5,0.71\n")
            run = Made(t, way, [Path(folder)])
            self.assertAlmostEqual(cases_contact.centre_error("x", "x")(run), 0.26 * 0.01, places=9)


if __name__ == "__main__":
    unittest.main()
