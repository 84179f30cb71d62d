"""Cases of the plan that there are no runs for, and why: listed on the page, never as passed."""

NOT_BUILT = {
    "X12": (
        "Dry collapse of a stack of cylinders",
        "the table contradicts its set-up: a centre of mass 0.101 m high at the start cannot be that of six layers of 10 mm (about 0.027 m)",
    ),
}
