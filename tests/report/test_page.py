"""What the page says, on rows whose outcome is known."""

import re
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import page
from case import Case, Chart, Finding, Measure, Trial, Variant, judged_at
from judge import times_to_targets
from runs import Place

LIGHT, HEAVY = Variant("light", {}, {"density": 500}), Variant("heavy", {}, {"density": 1000})


def case(name: str, **more) -> Case:
    """With harder targets for the light variant."""
    measure = Measure("e", "", lambda run: 0.0, lambda v: (0.1, 0.05) if v is LIGHT else (1.0, 0.5))
    return Case(name, "title", "about.", "scene", (("10s", 1.0),), (measure,), variants=(LIGHT, HEAVY), **more)


class Judged(unittest.TestCase):
    def test_variants_that_only_show_something_are_not_in_the_chart_of_errors(self):
        targets = judged_at((1.0,), density=1000)
        self.assertEqual((targets(LIGHT), targets(HEAVY)), ((), (1.0,)))
        rows = [{"measures": [{"scale": targets(v)[0] if targets(v) else None}, {"scale": None}]} for v in (LIGHT, HEAVY)]
        self.assertEqual(page.with_target(rows, 0), rows[1:])
        self.assertEqual(page.with_target(rows, 1), rows, "judged at none")


def row(of: Case, variant: Variant, value: float | None, h: float = 1.0, wall: float = 1.0, **more) -> dict:
    target = of.measures[0].target(variant, "10s")
    group = "/".join(x for x in (of.id, variant.name, "wcsph") if x)
    verdict = "met" if value is not None and value <= target else "missed"
    measure = {"name": "e", "unit": "", "value": value, "target": target, "note": "", "verdict": verdict, "scale": target}
    return {
        "id": f"{group}/{h:g}",
        "group": group,
        "case": of.id,
        "variant": variant.name,
        "method": "wcsph",
        "level": "10s",
        "h": h,
        "trial": "",
        "base": f"{group}/{h:g}",
        "status": "finished",
        "message": "",
        "wall_s": wall,
        "run": f"run {group}/{h:g}",
        "report": f"report {group}/{h:g}",
        "measures": [measure],
        "curves": [],
        "particles": 100,
        "steps": 9,
        "particle_steps_per_s": 1e6,
        "lost": 0,
        "scheme": "interlinked",
        "mass_drift": -0.25,
        "momentum_imbalance": 0.0,
        "energy_change_J": 3.0,
        "energy_balance_J": -2.0,
        "energy_scale_J": 8.0,
        "energy_gain": 0.0,
        "density_error": 0.01,
        "density_max": 0.02,
        "pressure_residual": 0,
        "interface_residual": 0,
        "stages": {"motion": 1.0},
    } | more


def written(cases: list[Case], rows: list[dict], trials: list[dict] = []) -> str:
    of_all = {"machine": "m", "version": "0", "commit": "c", "threads": "2", "written": "now", "level": "10s"}
    of_all |= {"wall_total": 1.0, "repeats": 1, "load": [0, 0], "command": "all"}
    with tempfile.TemporaryDirectory() as folder:
        place = Place(Path(folder), Path(folder), Path(folder))
        return page.write(place, cases, of_all | {"rows": rows, "trials": trials}, [], None, "").read_text()


class Targets(unittest.TestCase):
    def test_the_worst_variant_is_so_against_its_own_target(self):
        of = case("A")
        (line,) = page.summary([of], [row(of, LIGHT, 0.2), row(of, HEAVY, 0.9)])[:1]
        self.assertEqual((line["measures"][0]["variant"], line["measures"][0]["verdict"]), ("light", "missed"))
        self.assertEqual((line["measures"][0]["met"], line["measures"][0]["of"]), (1, 2))

    def test_a_variant_without_a_target_is_not_the_worst_of_a_measure(self):
        rows = [{"measures": [{"value": v, "target": t, "scale": t}]} for v, t in ((0.01, 0.1), (None, None))]
        self.assertIs(page.worst(rows, 0), rows[0])

    def test_times_stand_under_their_targets(self):
        of = case("A")
        light, heavy = times_to_targets(of, [row(of, LIGHT, 0.2), row(of, HEAVY, 0.2, wall=3.0)])
        self.assertEqual((light["targets"], light["lines"][0]["times"]), ((0.1, 0.05), [None, None]))
        self.assertEqual((heavy["targets"], heavy["lines"][0]["times"]), ((1.0, 0.5), [3.0, 3.0]))

    def test_a_target_of_0_is_no_line_on_a_logarithmic_axis(self):
        of = Case("A", "title", "about.", "scene", (("10s", 1.0),), (Measure("e", "", lambda run: 0.0, (0,)),))
        rows = [row(of, Variant(), 1.0), row(of, Variant(), 0.0, h=2.0)]
        self.assertTrue(page.error_chart(of, rows)["image"])


class Front(unittest.TestCase):
    def test_a_point_is_the_slowest_time_and_the_worst_error_and_names_its_run(self):
        of = case("A")
        (point,) = page.settings([row(of, LIGHT, 0.2, wall=5.0), row(of, HEAVY, 0.9, wall=1.0)], 0)
        self.assertEqual((point.wall_s, point.error, point.id), (5.0, 0.9, "A/heavy/wcsph/1"))
        self.assertEqual(page.settings([row(of, LIGHT, 0.2), row(of, HEAVY, None)], 0), [], "one failed")


class Charts(unittest.TestCase):
    def test_a_figure_that_must_be_zero_has_no_chart_and_no_time_to_reach_it(self):
        for target, charts in ((0.1, 2), (0.0, 1)):
            of = replace(case("A"), measures=(*case("A").measures, Measure("hit", "", lambda run: 0.0, (target,))))
            one = row(of, HEAVY, 0.1)
            one["measures"] = [one["measures"][0], one["measures"][0] | {"name": "hit", "target": target, "scale": target}]
            text = written([of], [one])
            self.assertEqual(text.count('alt="error against wall time"'), charts)
            self.assertEqual("wall time needed for hit" in text, target > 0)


class Words(unittest.TestCase):
    def test_reasons_stand_only_where_something_misses_or_does_not_converge(self):
        told = Finding(why="because of this.", order_why="because of that.\nAnd of more.")
        cases = [case("Met", finding=told), case("Missed", finding=told), case("Silent")]
        rows = [row(cases[0], HEAVY, 0.1, order=2.0)]
        rows += [row(c, HEAVY, 2.0, order=0.5) for c in cases[1:]]
        text = written(cases, rows)
        met, missed, silent = text.split("<h2 id=")[1:4]
        self.assertNotIn("because", met)
        self.assertIn("<b>Why it misses:</b> because of this.", missed)
        self.assertIn("<b>Why its order is below 1:</b><ul><li>because of that.</li><li>And of more.</li></ul>", missed)
        self.assertIn("<b>Why it misses:</b> not looked into.", silent)
        self.assertIn("<b>Why its order is below 1:</b> not looked into.", silent)

    def test_a_trial_is_shown_beside_its_run_and_not_judged(self):
        trial = Trial("less", "less of it", ("heavy/wcsph/1",))
        of = case("A", finding=Finding(why="{heavy/wcsph/1+less}, not {heavy/wcsph/1}.", trials=(trial,)))
        missed = row(of, HEAVY, 2.0)
        tried = row(of, HEAVY, 0.25) | {"id": "A/heavy/wcsph/1+less", "trial": "less", "report": "report of it"}
        text = written([of], [missed], [tried])
        self.assertIn('<a href="#A/heavy/wcsph/1+less">0.25</a>, not <a href="#A/heavy/wcsph/1">2</a>.', text)
        self.assertIn('id="A/heavy/wcsph/1+less"', text)
        self.assertIn(">less of it<", text)
        self.assertIn("<code>report of it</code>", text)
        self.assertIn("0 figures meet their target", text)

    def test_a_target_that_only_a_coarser_run_meets_is_told_from_one_that_none_does(self):
        of, never = case("A"), case("B")
        rows = [row(of, HEAVY, 0.4, h=2, wall=0.5), row(of, HEAVY, 2.0), row(never, HEAVY, 2.0)]
        first, second = re.findall(r'<tr class="first">.*?</tr>', written([of, never], rows), re.S)[:2]
        self.assertIn("coarser only", first)
        self.assertIn("not reached", second)

    def test_a_target_of_0_is_reached_by_a_run_that_has_0(self):
        of = replace(case("A"), measures=(Measure("hit", "", lambda run: 0.0, (0.0,)),))
        one = row(of, HEAVY, 0.0)
        [line] = page.summary([replace(of, methods=("wcsph",))], [one])
        self.assertEqual(line["to_target"], 1.0)
        one["measures"][0]["value"] = 1.0
        self.assertIsNone(page.summary([replace(of, methods=("wcsph",))], [one])[0]["to_target"])

    def test_a_second_chart_stands_beside_the_first(self):
        line = lambda name: Chart("t", name, lambda run: (0, 0), lambda v, f: ([0, 1], [0, 1]))
        of = replace(case("A"), chart=line("x"), second_chart=line("z"))
        curve = [[0.0, 1.0], [0.0, 2.0]]
        for curves, images in (([curve, curve], 2), ([curve, None], 1), ([], 0)):
            self.assertEqual(written([of], [row(of, HEAVY, 0.1, curves=curves)]).count('alt="run over reference"'), images)

    def test_every_run_has_its_commands_and_every_figure_of_the_summary_leads_to_a_run(self):
        of, stable = case("A"), case("S", stability=True)
        text = written([of, stable], [row(of, HEAVY, 0.1), row(stable, HEAVY, 0.1)])
        for group in ("A/heavy/wcsph/1", "S/heavy/wcsph/1"):
            for command in (f"run {group}", f"report {group}"):
                self.assertIn(f"<code>{command}</code>", text)
        for link in re.findall(r'href="#([^"]+)"', text):
            self.assertIn(f'id="{link}"', text)

    def test_mass_and_the_scale_of_energy_are_shown(self):
        of = case("A")
        text = written([of], [row(of, HEAVY, 0.1)])
        self.assertIn('<td class="n">-2 J<td class="n">8 J<td class="n">-25 %', text)

    def test_methods_say_their_coupling_scheme_and_where_it_is_another(self):
        of, joined = case("A"), case("B")
        rows = [row(of, HEAVY, 0.1), row(case("C"), HEAVY, 0.1), row(joined, HEAVY, 0.1, scheme="iterated")]
        (line,) = page.methods(rows)
        self.assertEqual(line["schemes"], [("interlinked", ["A", "C"]), ("iterated", ["B"])])


if __name__ == "__main__":
    unittest.main()
