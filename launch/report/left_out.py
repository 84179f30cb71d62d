"""What of the plan cases do without, or judge otherwise than it says: listed on the page, never as passed."""

LEFT_OUT = {
    "all cases": "wall times as medians of three runs: of one, or of as many as --repeats says",
    "B3n": "40 spacings per radius at 1e-5 m^2/s but at level 10min",
    "B4": "the sphere's window to 0.03 radii where it is longer than 40 ms (ratios 0.9 to 2)",
    "B4w": "a sphere in so wide a container; ratios 0.9 and 1.1 until 50 ms, before they have moved by 0.03 radii",
    "B7": "a start with the piston's speed alone: in the half swing of tension the fluid lets the piston go. A load of 100 Pa presses on it too, and one as heavy as the fluid, pushed in addition, lets go even so (the run stops with code 4)",
    "B10": "effective density by bisection of a free disc: from the force on a held one",
    "X6": "5 and 8 spacings per diameter at levels 10s and 1min: 3 and 4; the slow-down near the floor",
    "X9": "the pitching tank, a table for regression only: where its axis and its sensors are is not in the data, and a prescribed body turns at a constant speed only",
}
