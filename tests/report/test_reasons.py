"""Reasons: their figures come from results, and what they quote is run."""

import re
import unittest

import cases
import reasons
from case import LEVELS, Case, Finding, Measure, Trial, Variant, jobs_of, with_those_beside

LESS = Trial("less", "less of it", ("light/wcsph/0.5", "heavy/wcsph/0.25"), {"numerics.diffusion": "0.02"})
CASE = Case(
    "A",
    "title",
    "about",
    "scene",
    (("coarse", 1.0), ("10s", 0.5)),
    (Measure("share", "%", lambda r: 0.0, (0.1,)), Measure("way", "m", lambda r: 0.0)),
    methods=("wcsph",),
    variants=(Variant("light"), Variant("heavy")),
    finding=Finding(trials=(LESS,)),
)


def row(run: str, share: float | None, way: float = 0.0) -> dict:
    base, _, trial = f"A/{run}".partition("+")
    return {"id": f"A/{run}", "base": base, "trial": trial, "measures": [{"value": share}, {"value": way}]}


ROWS = [row("light/wcsph/1", 0.3), row("light/wcsph/0.5", 0.2, 7.0), row("heavy/wcsph/0.5", None)]
TRIALS = [row("light/wcsph/0.5+less", 0.125)]


def said(text: str) -> list[str]:
    lines = reasons.sentences(CASE, text, ROWS + TRIALS)
    return [re.sub(r"<[^>]+>", "", line) for line in lines]


class Sentences(unittest.TestCase):
    def test_figures_are_those_of_the_runs(self):
        self.assertEqual(said("{light/wcsph/1}, {light/wcsph/0.5|1}."), ["30 %, 7 m."])
        self.assertEqual(said("{light/wcsph/*} and {light/wcsph/0.5+less}"), ["20 to 30 % and 12.5 %"])
        self.assertEqual(said("one\ntwo"), ["one", "two"])

    def test_a_run_that_is_not_there_is_said_to_be_missing(self):
        self.assertEqual(said("{heavy/wcsph/0.25+less}; {heavy/wcsph/0.5}"), [f"{reasons.NO_RUN}; none", reasons.LATER.format("A")])

    def test_a_figure_leads_to_its_run_and_text_is_no_markup(self):
        [line] = reasons.sentences(CASE, "a < b: {light/wcsph/1}", ROWS)
        self.assertEqual(line, 'a &lt; b: <a href="#A/light/wcsph/1">30 %</a>')

    def test_trials_stand_behind_the_run_that_they_change(self):
        lines = reasons.tried(CASE, ROWS, TRIALS)
        self.assertEqual([(line["row"]["id"], line["changed"]) for line in lines], [("A/light/wcsph/0.5", ""), ("A/light/wcsph/0.5+less", "less of it")])


    def test_a_trial_that_changes_nothing_says_so(self):
        before, after = row("light/wcsph/0.5", 0.2) | {"state_hash": "a"}, row("light/wcsph/0.5+less", 0.2) | {"state_hash": "a"}
        self.assertIn("it changes nothing here", reasons.tried(CASE, [before], [after])[1]["changed"])
        self.assertEqual(reasons.tried(CASE, [before], [after | {"state_hash": "b"}])[1]["changed"], "less of it")


class Trials(unittest.TestCase):
    def test_they_are_made_from_the_level_1min_on_with_what_they_change(self):
        self.assertEqual([job.id for job in jobs_of(CASE, "10s", None) if job.trial], [])
        made = [job for job in jobs_of(CASE, "1min", None) if job.trial]
        self.assertEqual([job.id for job in made], ["A/light/wcsph/0.5+less", "A/heavy/wcsph/0.25+less"])
        self.assertEqual(made[0].overrides()["numerics.diffusion"], "0.02")
        everything = jobs_of(CASE, "1min", None)
        self.assertEqual([job.id for job in with_those_beside(made[:1], everything)], ["A/light/wcsph/0.5", "A/light/wcsph/0.5+less"])


class Findings(unittest.TestCase):
    def test_texts_quote_runs_that_are_made_and_no_figure_by_hand(self):
        for case in cases.ALL:
            finding = case.finding
            jobs = [{"id": job.id, "trial": job.trial} for job in jobs_of(case, "1min", None)]
            for text in (finding.why, finding.order_why):
                for run, measure in reasons.fields(text):
                    with self.subTest(case.id, run=run):
                        self.assertTrue(reasons.matching(case.id, run, jobs), "no such run")
                        self.assertLess(measure, len(case.measures))
                by_hand = re.findall(r"\d ?%", reasons.FIELD.sub("", text))
                self.assertEqual(by_hand, [], f"{case.id}: an error that no run stands behind")
                self.assertTrue(not text or text.rstrip(")").endswith("."), f"{case.id}: sentences end with a full stop")

    def test_every_trial_is_quoted(self):
        for case in cases.ALL:
            quoted = [run for text in (case.finding.why, case.finding.order_why) for run, _ in reasons.fields(text)]
            for job in (job for job in jobs_of(case, LEVELS[-1], None) if job.trial):
                with self.subTest(job.id):
                    self.assertTrue(any(reasons.matching(case.id, run, [{"id": job.id, "trial": job.trial}]) for run in quoted))


if __name__ == "__main__":
    unittest.main()
