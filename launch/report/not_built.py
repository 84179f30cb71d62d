"""Figures of the plan that cases do without, or judge otherwise than it says: listed on the page, never as passed."""

LEFT_OUT = {
    "B10": "a disc that turns with its fluid; a cube in 3-D",
    "X1": "when the water arrives",
    "X8": "the speed of the water",
}
