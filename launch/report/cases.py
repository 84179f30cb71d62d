"""All cases, in the order of the page."""

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
import stability
from case import Case

ALL: tuple[Case, ...] = (
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
