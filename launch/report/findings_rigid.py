"""What was found out about cases of bodies alone."""

from case import Finding, Trial

EXACT = Finding(order_why="exact at every step; what is left is round-off.")

FINDINGS = {
    "R1": EXACT,
    "R2": EXACT,
    "R3": Finding(
        order_why="less than a tenth of a microsecond at every step: the plate's thickness, and linear interpolation between rows."
    ),
    "R4": Finding(
        order_why="up to 150 degrees the period is right within 1e-5, of either sign. At 179 degrees it hangs on the amplitude (9 times the radians that are lost), of which "
        "steps of 4, 2 and 1 ms lose {179deg/ode/0.004|1}, {179deg/ode/0.002|1} and {179deg/ode/0.001|1} a period, 0.5 ms {179deg/ode/0.0005|1}."
    ),
    "R7": Finding(
        order_why="a cylinder that slips rocks from end to end, as its contacts change from step to step: up to 3 rad/s, and 0.2 m to the side in 1 s, with steps of 4 and 2 ms, 1 rad/s and 0.02 m with 1 and 0.5 ms; "
        "the other three are of first order."
    ),
    "R7s": EXACT,
    "R8": Finding(order_why="steps are cut at impacts, so that their length hardly matters: heights are off by 0.01 mm and less."),
    "R9": Finding(order_why="the same at every step: contacts are soft by 1e-9 of the inverse mass."),
    "R11": Finding(
        order_why="0.045 degrees at every step: the slab goes on for the 0.45 s in which the box turns by the 0.2 degrees that count as tipping."
    ),
    "R12h": Finding(order_why="the light one on the heavy one moves by less than a nanometre with every step."),
    "R13t": EXACT,
    "R14": Finding(
        order_why="{ode/*} with every step, in fast turns 8.7 and 9.3 s after the start. With steps longer than 1 ms it goes up and down, by where in a fast turn they fall: {ode/0.0015+between}, {ode/0.002}, {ode/0.003+between} and {ode/0.004} with 1.5, 2, 3 and 4 ms. From 1 ms on it falls with an order of 2: {ode/0.001}, {ode/0.0005+shorter} and {ode/0.00025+shorter} with 1, 0.5 and 0.25 ms.",
        trials=(
            Trial("between", "steps of 1.5 and 3 ms", ("ode/0.0015", "ode/0.003")),
            Trial("shorter", "steps of 0.5 and 0.25 ms", ("ode/0.0005", "ode/0.00025")),
        ),
    ),
    "R15": Finding(order_why="of the sphere at every step only round-off is left."),
    "X12": Finding(
        order_why="with friction of 0.3, which way loose cylinders fall is decided by little, as said above. With 0.15 and 0.45, shown only, the step no longer matters ({mu0.15/ode/0.0005} and {mu0.15/ode/0.0001}, {mu0.45/ode/0.0005} and {mu0.45/ode/0.0001}): there it is the friction that is wrong."
    ),
}
