"""All cases, in the order of the page."""

import cases_contact
import cases_coupled
import cases_experiment
import cases_fluid
import cases_rigid
import cases_viscous
import cases_waves
from case import Case

ALL: tuple[Case, ...] = (
    *cases_fluid.CASES,
    *cases_coupled.CASES,
    *cases_viscous.CASES,
    *cases_waves.CASES,
    *cases_experiment.CASES,
    *cases_rigid.CASES,
    *cases_contact.CASES,
)
