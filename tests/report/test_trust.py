"""Live figures against true errors, on rows with known ranks."""

import unittest

import trust
from case import Case, Measure


def row(case: str, density: float, error: float | None, status: str = "finished", target: float = 0.1) -> dict:
    measure = {"name": "e", "unit": "", "value": error, "target": None, "scale": target}
    return {
        "case": case,
        "method": "wcsph",
        "status": status,
        "particles": 9,
        "density_error": density,
        "measures": [measure],
    }


def case(name: str) -> Case:
    return Case(name, "", "", "", (), (Measure("e", "", lambda run: 0.0, (0.1,)),))


class Trust(unittest.TestCase):
    def first(self, rows: list[dict]) -> dict:
        return trust.table([case("A"), case("B")], rows, least=1)["rows"][0]

    def test_inside_cases_and_over_all_are_told_apart(self):
        # Inside each case the error grows with the figure; B has smaller figures and larger errors.
        rows = [row("A", d, d) for d in (10, 11, 12, 13)] + [row("B", d, 100 * d) for d in (1, 2, 3, 4)]
        line = self.first(rows)
        self.assertAlmostEqual(line["within"], 1, places=12)
        self.assertEqual(line["within_count"], 8)
        self.assertLess(line["all"], 0)

    def test_a_report_of_a_few_runs_says_nothing(self):
        rows = [row("A", d, d) for d in range(1, trust.LEAST_IN_ALL + 1)]
        self.assertEqual(len(trust.table([case("A")], rows)["rows"]), len(trust.LIVE))
        self.assertEqual(trust.table([case("A")], rows[1:])["rows"], [])

    def test_cases_weigh_by_their_runs(self):
        rows = [row("A", d, d) for d in range(1, 7)] + [row("B", d, -d + 9) for d in range(1, 5)]
        self.assertAlmostEqual(self.first(rows)["within"], (6 - 4) / 10, places=12)

    def test_runs_without_a_true_error_do_not_count(self):
        rows = [row("A", d, d) for d in (1, 2, 3, 4)]
        rows += [row("A", 9, 0.1, "diverged"), row("A", 9, None), row("A", 9, float("inf")), row("C", 9, 0.0)]
        self.assertEqual(self.first(rows)["count"], 4)

    def test_what_never_varies_is_said_to_be_no_measure(self):
        line = self.first([row("A", 0.0, d) for d in (1, 2, 3, 4)])
        self.assertIsNone(line["within"])
        self.assertIn("no measure", line["word"])


if __name__ == "__main__":
    unittest.main()
