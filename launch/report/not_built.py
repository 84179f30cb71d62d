"""What of the plan there are no runs for, and why: listed on the page, never as passed."""

NOT_BUILT = {
    "X12": (
        "Dry collapse of a stack of cylinders",
        "the table contradicts its set-up: a centre of mass 0.101 m high at the start cannot be that of six layers of 10 mm (about 0.027 m)",
    ),
}

# Figures of the plan that cases do without, or judge otherwise than it says.
LEFT_OUT = {
    "F1": "the largest speed: the rms speed is held to its target",
    "F6": "whether voids open until omega t = 2",
    "B1": "the box of another code's record, which rolls to 45 degrees",
    "B3": "a viscosity of 1e-5 m^2/s",
    "B4": "the wider container, q = 5",
    "B5": "angular momentum with the impulse of the wall, to 1e-6",
    "B9": "an offset of 5 mm at 32 spacings across: tried once, see its reasons",
    "B10": "a disc that turns with its fluid; a cube in 3-D",
    "B12": "the largest pressure",
    "B13": "the gate let go",
    "X1": "when the water arrives",
    "X8": "the speed of the water",
    "R9": "momentum to 1e-12: 1e-8, as rows of bodies have nine digits",
    "R13": "static tension",
}
