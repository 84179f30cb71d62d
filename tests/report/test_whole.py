"""The command `report` from cases to page, on runs of less than a second."""

import csv
import fcntl
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
BOXES = ["R0/box/ode/0.001", "R0/box/free_body/0.001"]
CHEAP_FLUID = "F1/wcsph/0.1"
CHEAP = ["R4/90deg/ode/0.002", "R4/90deg/ode/0.001"]


class Report(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.out = Path(self.scratch.name)

    def tearDown(self):
        self.scratch.cleanup()

    def report(self, *words: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            [sys.executable, "-B", TREE / "launch/report", *words, "--build", os.environ["BALLAST_BUILD"]],
            capture_output=True,
            text=True,
            cwd=self.out,
        )

    def rows(self, folder: str) -> dict[str, dict]:
        return {r["id"]: r for r in json.loads((self.out / folder / "results_part.json").read_text())["rows"]}

    def test_a_report_has_figures_and_a_page_without_links_to_a_network(self):
        done = self.report(*CHEAP, "--out", "a")
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = self.rows("a")
        self.assertEqual(sorted(rows), sorted(CHEAP))
        for row in rows.values():
            self.assertEqual(row["status"], "finished")
            self.assertLess(row["measures"][0]["value"], 1e-4)
        page = (self.out / "a/report_part.html").read_text()
        self.assertNotIn("http", page)
        self.assertGreaterEqual(page.count("data:image/svg+xml"), 2)
        self.assertIn(rows[CHEAP[0]]["run"].replace('"', "&#34;").replace("'", "&#39;"), page)

    def test_one_run_of_a_case_draws_the_set_up_and_the_last_state(self):
        self.report(*CHEAP, "--out", "a")
        for name in ("start.png", "picture.png"):
            found = [p.parent for p in (self.out / "a/runs").rglob(name)]
            self.assertEqual(found, [self.out / "a/runs" / CHEAP[1]] if shutil.which("povray") else [], name)

    def test_the_table_has_what_is_conserved_beside_every_measure(self):
        self.report("F1/wcsph/0.1", "--out", "a")
        with (self.out / "a/results_part.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 5)
        for row in rows:
            self.assertEqual(float(row["mass_drift"]), 0)
            self.assertLess(abs(float(row["energy_balance_J"])), 0.01 * float(row["energy_scale_J"]))
            self.assertGreater(float(row["density_error"]), 0)
            self.assertEqual(row["command"].split()[1], "run")
            self.assertEqual(row["report"].split()[1], "report")
        pressure = json.loads((self.out / "a/results_part.json").read_text())["rows"][0]["measures"][0]
        self.assertEqual(rows[0]["unit"], "%")  # a share in the JSON, per cent for whoever reads the table
        self.assertAlmostEqual(float(rows[0]["value"]), 100 * pressure["value"])

    def test_the_speed_of_a_sphere_in_its_box_follows_from_momentum_at_all_times(self):
        import cases_viscous
        from case import Outcome, Variant

        run = "B8/wcsph/0.0224"
        self.report(run, "--out", "a")
        outcome = Outcome(self.out / "a/runs" / run, 0.0224, Variant(), [])
        last = cases_viscous.settling_speed(outcome)[1][-1]
        self.assertAlmostEqual(last / cases_viscous.SETTLED, cases_viscous.settling(outcome), places=5)

    def test_the_work_on_the_gate_adds_up_to_the_record_s(self):
        import cases_waves
        from case import Outcome, Variant

        run = "B13r/implicit/0.05"
        self.report(run, "--out", "a")
        outcome = Outcome(self.out / "a/runs" / run, 0.05, Variant(), [])
        energy, work = cases_waves.gate_energy(outcome)
        ledger = outcome.record["ledger"]["energy_J"]
        self.assertAlmostEqual(work[-1], ledger["work_on_bodies"], places=3)
        self.assertAlmostEqual(energy[0], ledger["bodies_start"], places=6)
        self.assertAlmostEqual(energy[-1], ledger["bodies_end"], places=6)

    def test_the_stack_of_cylinders_starts_where_the_table_of_its_widths_has_it(self):
        import cases_contact
        from case import Outcome, Variant

        run = "X12/mu0.3/ode/0.002"
        self.report(run, "--out", "a")
        outcome = Outcome(self.out / "a/runs" / run, 0.002, Variant(), [])
        start = [sum(outcome.values(f"{n}.{c}")[0] for n in cases_contact.CYLINDERS) / 33 for c in "xz"]
        self.assertAlmostEqual(start[0], 0.03, places=12)
        self.assertAlmostEqual(start[1], 0.005 + 0.01 * 0.75**0.5 * (6 * (0 + 2 + 4) + 5 * (1 + 3 + 5)) / 33, places=12)
        self.assertLess(abs(start[1] - 0.1006 * cases_contact.BOX), 2e-4)

    def test_the_gate_lets_only_finished_runs_that_meet_their_targets_through(self):
        self.assertEqual(self.report(CHEAP[0], "--gate", "--out", "a").returncode, 0)
        diverges = self.report("B4/r0.01/staggered/0.02", "--gate", "--out", "a")
        self.assertEqual(diverges.returncode, 3, diverges.stderr)

    def test_one_that_is_stopped_writes_what_is_finished(self):
        for stop, out in ((signal.SIGINT, "a"), (signal.SIGTERM, "b")):
            with self.subTest(stop.name):
                self.stopped(stop, out)

    def stopped(self, stop: signal.Signals, out: str) -> None:
        long = "F1/wcsph/0.00625"
        process = subprocess.Popen(
            [sys.executable, "-B", TREE / "launch/report", CHEAP_FLUID, long, "--out", out]
            + ["--build", os.environ["BALLAST_BUILD"]],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            cwd=self.out,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # whoever started the tests may ignore it
        )
        begun = self.out / out / "runs" / long / "log.txt"
        for _ in range(600):
            if begun.is_file():
                break
            time.sleep(0.05)
        process.send_signal(stop)
        said = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 5, said)
        self.assertIn("stopped after 1 of 2 runs", said)
        self.assertEqual(list(self.rows(out)), [CHEAP_FLUID])
        results = json.loads((self.out / out / "results_part.json").read_text())
        self.assertEqual(results["stopped"], "stopped after 1 of 2 runs")
        with (self.out / out / "results_part.csv").open() as file:
            self.assertEqual({row["run"] for row in csv.DictReader(file)}, {CHEAP_FLUID})
        self.assertEqual([p.name for p in (self.out / out).glob("*") if p.suffix in (".part", ".html")], [])
        self.assertFalse((self.out / out / "runs" / long / "run.json").exists(), "a run that was stopped is made again")

    def test_only_one_report_is_at_work(self):
        with open(Path(tempfile.gettempdir()) / f"ballast_report.{os.getuid()}.lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            done = self.report(CHEAP[0], "--out", "a")
        self.assertEqual(done.returncode, 2)
        self.assertIn("another report is at work", done.stderr)

    def test_finished_runs_are_kept_until_asked_for_again(self):
        self.report(CHEAP[0], "--out", "a")
        first = self.rows("a")[CHEAP[0]]["walls"]
        self.report(CHEAP[0], "--out", "a")
        self.assertEqual(self.rows("a")[CHEAP[0]]["walls"], first)
        self.report(CHEAP[0], "--out", "a", "--again")
        self.assertNotEqual(self.rows("a")[CHEAP[0]]["walls"], first)

    def test_the_trial_of_shorter_steps_makes_twice_as_many(self):
        import trials

        steps = []
        for overrides in ({}, trials.short_steps().overrides):
            words = ["run", "scenes/hydrostatic.yaml", "--spacing", "0.1", "--duration", "0.5", "--no-expect", "--quiet", "--out", str(self.out)]
            words += [word for path, value in overrides.items() for word in ("--set", f"{path}={value}")]
            program = Path(os.environ["BALLAST_BUILD"]) / "bin/ballast_coordinator"
            subprocess.run([program, *words], cwd=TREE, check=True, capture_output=True)
            steps.append(json.loads((self.out / "record.json").read_text())["steps"])
        self.assertAlmostEqual(steps[1] / steps[0], 2, delta=0.1)

    def test_a_printed_command_makes_the_same_run(self):
        self.report(CHEAP[0], "--out", "a")
        row = self.rows("a")[CHEAP[0]]
        import shlex

        words = shlex.split(row["run"])
        program = Path(os.environ["BALLAST_BUILD"]) / "bin/ballast_coordinator"
        subprocess.run(
            [program, *words[1:], "--quiet", "--out", self.out / "b"], cwd=TREE, check=True, capture_output=True
        )
        record = json.loads((self.out / "b/record.json").read_text())
        self.assertEqual(record["state_hash"], row["state_hash"])
        self.assertTrue(row["state_hash"])

    def test_a_reference_that_is_not_there_is_never_passed(self):
        from judge import judge
        from case import Case, Job, Measure, Variant
        from references import read_table
        from runs import Place

        self.report(CHEAP[0], "--out", "a")
        case = Case(
            "R4",
            "",
            "",
            "report/pendulum",
            (),
            (Measure("track", "m", lambda run: read_table("absent.csv", run.references)["x"], (1.0,)),),
            knob="coupling.rigid_step",
        )
        place = Place(TREE, Path("unused"), self.out / "a")
        note = json.loads((self.out / "a/runs" / CHEAP[0] / "run.json").read_text())
        row = judge(place, Job(case, Variant("90deg"), "ode", "10s", 0.002), note, [self.out])
        self.assertEqual(row["measures"][0]["verdict"], "reference not installed")

    def test_a_run_without_a_figure_is_a_miss(self):
        from judge import judge
        from case import Case, Job, Measure
        from case import Variant
        from runs import Place

        case = Case("R4", "", "", "report/pendulum", (), (Measure("any", "", lambda run: 0.0, (1.0,)),))
        note = {"status": "diverged", "message": "why", "wall_s": None, "walls": [], "started": "", "load": 0}
        row = judge(Place(TREE, self.out, self.out), Job(case, Variant(), "ode", "10s", 0.002), note, [])
        self.assertEqual((row["status"], row["measures"][0]["verdict"]), ("diverged", "missed"))
        beyond = Case(**{**vars(case), "stability": True, "to_the_limit": True})
        row = judge(Place(TREE, self.out, self.out), Job(beyond, Variant(), "ode", "10s", 0.002), note, [])
        self.assertEqual(row["measures"][0]["verdict"], "no target", "a clean stop beyond the limit is what is wanted")

    def test_words_behind_the_methods_are_cases(self):
        done = self.report("--methods", "ode", CHEAP[0], "--out", "a")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(list(self.rows("a")), [CHEAP[0]])

    def test_whole_ids_and_patterns_go_together(self):
        done = self.report(CHEAP[0], "R0/box", "--list")
        self.assertEqual([x.split()[0] for x in done.stdout.splitlines()], [*BOXES, CHEAP[0]], done.stderr)

    def test_methods_that_are_none_are_refused(self):
        for words in (["--methods", "F1"], ["--methods", "ode", "wscph"]):
            done = self.report(*words, "--out", "a")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words[-1], done.stderr)
            self.assertIn("methods are wcsph", done.stderr)

    def test_a_stability_run_is_in_its_own_table(self):
        self.report("S08/c11/wcsph/0.025", "--out", "a")
        (row,) = self.rows("a").values()
        page = (self.out / "a/report_part.html").read_text()
        self.assertIn('id="stability"', page)
        self.assertNotIn('id="S08"', page)
        import page as pages
        import stability

        case = next(c for c in stability.CASES if c.id == "S08")
        (line,) = pages.stability([case], [row])
        self.assertEqual(line["rows"][0]["stable"], "stable")
        leaked = {**row, "measures": [{**row["measures"][0], "value": 1.0, "verdict": "missed"}, *row["measures"][1:]]}
        stopped = {**row, "status": "diverged"}
        for bad in (leaked, stopped):
            self.assertEqual(pages.stability([case], [bad])[0]["rows"][0]["stable"], "not stable")

    def test_an_unknown_case_is_refused_by_name(self):
        done = self.report("Z9", "--out", "a")
        self.assertEqual(done.returncode, 2)
        self.assertIn("Z9", done.stderr)
        self.assertEqual(self.report("X7", "--list").stdout.count("X7a/"), self.report("X7a", "--list").stdout.count("X7a/"), "a part of the plan's X7")
        self.assertIn("no run fits f1/WCSPH, but F1/wcsph would", self.report("f1/WCSPH", "--out", "a").stderr)

    def test_a_method_that_does_not_run_a_case_is_named_with_those_that_do(self):
        done = self.report("F1", "--methods", "ode", "--out", "a")
        self.assertEqual(done.returncode, 2)
        self.assertIn("F1 is not run by ode, but by wcsph, implicit", done.stderr)

    def test_the_gate_does_not_open_where_a_reference_is_missing(self):
        (self.out / "empty").mkdir()
        done = self.report("X12/mu0.3/ode/0.002", "--references", "empty", "--gate", "--out", "a")
        self.assertIn("2 without reference", done.stdout)
        self.assertEqual(done.returncode, 3, done.stderr)

    def test_folders_that_are_none_are_refused(self):
        for words in (["--references", "nowhere"], ["--out", "/proc/report"]):
            done = self.report(CHEAP[0], *words)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(words[0], done.stderr)
            self.assertIn(words[1], done.stderr)
            self.assertNotIn("Traceback", done.stderr)

    def test_against_older_results_tells_better_from_worse(self):
        import compare

        def results(error: float, wall: float, load: float = 2.0) -> dict:
            return {
                "machine": "m",
                "rows": [
                    {
                        "id": "F1/x",
                        "status": "finished",
                        "threads": 2,
                        "load": load,
                        "wall_s": wall,
                        "walls": [wall],
                        "measures": [{"name": "e", "unit": "", "value": error}],
                    }
                ],
            }

        def words(old: dict, new: dict) -> list[str]:
            return [line["word"] for line in compare.changes(old, new, "old")["lines"]]

        self.assertEqual(words(results(0.1, 10), results(0.1, 11)), [])
        self.assertEqual(words(results(0.1, 10), results(0.05, 20)), ["better", "slower"])
        self.assertEqual(words(results(0.1, 10), results(0.2, 5)), ["worse", "faster"])
        self.assertEqual(words(results(0.1, 10), results(0.2, 5, load=4)), ["worse"], "others were at work")
        self.assertIn("against old: 1 better, 1 slower;", compare.in_words(compare.changes(results(0.1, 10), results(0.05, 20), "old")))
        self.assertIn("others were at work on the machine: 1 runs", compare.changes(results(0.1, 10, 4), results(0.1, 5), "old")["note"])


if __name__ == "__main__":
    unittest.main()
