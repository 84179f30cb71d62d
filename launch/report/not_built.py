"""Figures of the plan that cases do without, or judge otherwise than it says: listed on the page, never as passed."""

LEFT_OUT = {
}
