"""What of the plan there are no runs for, and why: listed on the page, never as passed."""

NOT_BUILT = {
    "X12": (
        "Dry collapse of a stack of cylinders",
        "the table contradicts its set-up: a centre of mass 0.101 m high at the start cannot be that of six layers of 10 mm (about 0.027 m)",
    ),
}

# Figures of the plan that cases do without, or judge otherwise than it says.
LEFT_OUT = {
    "B10": "a disc that turns with its fluid; a cube in 3-D",
    "B12": "the largest pressure",
    "B13": "the gate let go",
    "X1": "when the water arrives",
    "X8": "the speed of the water",
    "R13": "static tension",
}
