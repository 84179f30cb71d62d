"""Verdicts put together, on rows whose outcome is known."""

import unittest
from dataclasses import replace

import judge
from case import Case, Measure, Variant, jobs_of, with_those_beside


def case(name: str, methods: tuple[str, ...] = ("wcsph", "implicit"), unit: str = "") -> Case:
    return Case(name, "", "", "", (), (Measure("e", unit, lambda run: 0.0, (0.1, 0.01)),), methods)


def row(name: str, method: str, verdict: str, level: str = "10s", h: float = 1, value: float = 0.05, unit: str = "") -> dict:
    target = None if verdict == "no target" else 0.1
    return {
        "case": name,
        "method": method,
        "level": level,
        "group": f"{name}/{method}",
        "variant": "",
        "h": h,
        "wall_s": 1.0,
        "measures": [{"name": "e", "unit": unit, "value": value, "target": target, "verdict": verdict}],
    }


class Jobs(unittest.TestCase):
    def test_a_variant_is_not_run_where_it_goes_without(self):
        swept = replace(
            case("X1", ("wcsph",)),
            resolutions=(("10s", 2.0), ("1min", 1.0)),
            variants=(Variant("judged"), Variant("shown", without=(2.0,))),
        )
        self.assertEqual(
            [job.id for job in jobs_of(swept, "1min", None)], ["X1/judged/wcsph/2", "X1/judged/wcsph/1", "X1/shown/wcsph/1"]
        )


    def test_a_run_chosen_alone_brings_the_one_that_its_figures_need(self):
        compared = replace(
            case("X6g", ("wcsph",)),
            resolutions=(("coarse", 2.0), ("10s", 1.0)),
            variants=(Variant("reduced"), Variant("full")),
            beside=lambda job: (Variant("reduced"), 2.0),
        )
        everything = jobs_of(compared, "10s", None)
        alone = [job for job in everything if job.id == "X6g/full/wcsph/1"]
        self.assertEqual(
            [job.id for job in with_those_beside(alone, everything)], ["X6g/reduced/wcsph/2", "X6g/full/wcsph/1"]
        )
        self.assertEqual(with_those_beside(everything, everything), everything)


class MetByLevel(unittest.TestCase):
    def test_one_solver_is_enough_for_a_case_and_each_counts_by_itself(self):
        rows = [
            row("B1", "wcsph", "met"),
            row("B1", "implicit", "met"),
            row("B1", "implicit", "missed"),  # another variant
            row("B1", "staggered", "missed"),
            row("B1", "wcsph", "missed", "1min"),
            row("X1", "wcsph", "missed"),
            row("X7", "wcsph", "no target"),
            row("R1", "wcsph", "missed"),
        ]
        cases = [case("B1", ("wcsph", "implicit", "staggered")), case("X1"), case("X7"), case("R1")]
        ten, minute = judge.met_by_level(cases, rows)
        self.assertEqual((ten["cases_met"], ten["cases"]), (1, 2))
        self.assertEqual(ten["by_method"], [("wcsph", 1, 2), ("implicit", 0, 1)])
        self.assertEqual(ten["missed"], ["X1"])
        self.assertEqual((minute["level"], minute["cases_met"], minute["cases"]), ("1min", 0, 2))

    def test_a_case_without_a_run_at_a_level_counts_there_as_at_the_level_below(self):
        rows = [row("X6g", "wcsph", "missed"), row("B4", "implicit", "met")]
        rows += [row("X6", "wcsph", "met", "1min"), row("B1", "wcsph", "met", "1min"), row("B4", "wcsph", "missed", "1min")]
        [ten, minute] = judge.met_by_level([case("X6g"), case("X6"), case("B1"), case("B4", ("wcsph", "implicit"))], rows)
        self.assertEqual((ten["cases_met"], ten["cases"]), (1, 2))
        self.assertEqual((minute["cases_met"], minute["cases"], minute["numbers_met"], minute["numbers"]), (2, 4, 1, 3))
        self.assertEqual(set(minute["missed"]), {"X6g", "B4"}, "another solver's run does not stand for the one missed")

    def test_a_reference_that_is_not_installed_is_neither_met_nor_missed(self):
        absent = row("X1", "wcsph", "reference not installed")
        absent["measures"][0]["value"] = None
        self.assertEqual(judge.met_by_level([case("X1")], [absent]), [])
        half = row("X4", "wcsph", "met")
        half["measures"] += absent["measures"]
        rows = [half, row("X4b", "wcsph", "met"), row("B4", "wcsph", "met")]
        [ten] = judge.met_by_level([case(r["case"]) for r in rows], rows)
        self.assertEqual((ten["cases_met"], ten["cases"], ten["unjudged"]), (2, 2, ["X4"]))
        self.assertEqual((ten["numbers_met"], ten["numbers"]), (1, 1), "B4; of X4 one part is not judged")

    def test_a_headline_is_met_if_all_its_parts_are(self):
        rows = [row("B4", "wcsph", "met"), row("B4s", "implicit", "missed"), row("B7", "wcsph", "met"), row("B5", "wcsph", "met")]
        [ten] = judge.met_by_level([case(r["case"]) for r in rows], rows)
        self.assertEqual(ten["headlines"], [("B4", "B4", False), ("B7", "B7", True)])

    def test_the_parts_of_a_case_count_as_one_that_is_met_if_all_are(self):
        rows = [row("B4", "wcsph", "met"), row("B4s", "implicit", "missed"), row("F5", "wcsph", "met"), row("F5f", "wcsph", "met")]
        [ten] = judge.met_by_level([case(r["case"]) for r in rows], rows)
        self.assertEqual((ten["cases_met"], ten["cases"], ten["numbers_met"], ten["numbers"]), (3, 4, 1, 2))


class Slow(unittest.TestCase):
    def test_runs_beyond_twice_their_level_are_named(self):
        rows = [row("B1", "wcsph", "met") | {"wall_s": wall} for wall in (19.0, 21.0, None)]
        self.assertEqual([r["wall_s"] for r in judge.too_slow(rows)], [21.0])


class Order(unittest.TestCase):
    def test_an_error_that_stays_the_same_in_spacings_is_of_first_order(self):
        for unit, order in (("dx", 1), ("", 0)):
            rows = [row("B1", "wcsph", "met", h=h, unit=unit) for h in (2, 1)]
            judge.mark(rows)
            self.assertAlmostEqual(rows[1]["order"], order)


if __name__ == "__main__":
    unittest.main()
