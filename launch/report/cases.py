"""All cases with what was found out about them, in the order of the page."""

from dataclasses import replace

import cases_contact
import cases_coupled
import cases_drop
import cases_experiment
import cases_fluid
import cases_loads
import cases_mass
import cases_rigid
import cases_sinking
import cases_spin
import cases_surface
import cases_viscous
import cases_waves
import findings_bodies
import findings_experiment
import findings_fluid
import findings_rigid
import findings_viscous
import findings_waves
import stability
from case import Case, Finding

FINDINGS: dict[str, Finding] = {
    **findings_fluid.FINDINGS,
    **findings_bodies.FINDINGS,
    **findings_viscous.FINDINGS,
    **findings_waves.FINDINGS,
    **findings_experiment.FINDINGS,
    **findings_rigid.FINDINGS,
}

ALL: tuple[Case, ...] = tuple(
    replace(case, finding=FINDINGS.get(case.id, Finding()))
    for case in (
        *cases_fluid.CASES,
        *cases_surface.CASES,
        *cases_coupled.CASES,
        *cases_drop.CASES,
        *cases_viscous.CASES,
        *cases_waves.CASES,
        *cases_experiment.CASES,
        *cases_loads.CASES,
        *cases_sinking.CASES,
        *cases_mass.CASES,
        *cases_rigid.CASES,
        *cases_spin.CASES,
        *cases_contact.CASES,
        *stability.CASES,
    )
)
