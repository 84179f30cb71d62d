"""The table of cases: what it names exists, and every scene that it makes is accepted."""

import os
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import cases
from case import LEVELS, METHODS, jobs_of
from runs import Place, effective_scene

TREE = Path(__file__).resolve().parents[2]


class Cases(unittest.TestCase):
    def test_ids_and_groups_are_unique(self):
        ids = [job.id for case in cases.ALL for job in jobs_of(case, LEVELS[-1], None)]
        self.assertEqual(len(ids), len(set(ids)))

    def test_every_case_is_whole(self):
        for case in cases.ALL:
            with self.subTest(case.id):
                self.assertLessEqual(set(case.methods), set(METHODS))
                self.assertTrue(case.measures[0].targets or "without a target" in case.about)
                self.assertIn("10s", [level for level, _ in case.resolutions])
                sizes = [h for _, h in case.resolutions]
                self.assertEqual(sizes, sorted(sizes, reverse=True), "coarse to fine")
                for measure in case.measures:
                    for variant in case.variants:
                        targets = list(measure.targets_of(variant))
                        self.assertEqual(targets, sorted(targets, reverse=True), "targets get harder")

    def test_every_scene_is_accepted_and_depends_on_what_is_varied(self):
        place = Place(TREE, Path(os.environ["BALLAST_BUILD"]), TREE)
        jobs = [job for case in cases.ALL for job in jobs_of(case, "10s", None) if job.level == "10s"]
        with ThreadPoolExecutor(2) as pool:
            scenes = list(pool.map(lambda job: effective_scene(place, job), jobs))
        for case in cases.ALL:
            mine = [scene for job, scene in zip(jobs, scenes) if job.case is case]
            self.assertEqual(len(mine), len(set(mine)), f"{case.id}: two variants or methods are the same scene")


if __name__ == "__main__":
    unittest.main()
