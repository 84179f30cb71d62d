"""What of the plan cases do without, or judge otherwise than it says: listed on the page, never as passed."""

LEFT_OUT = {
    "all cases": "wall times as medians of three runs: of one, or of as many as --repeats says",
    "F2": "the mean over all particles: velocities at 16 points",
    "B3": "40 spacings per radius at 1e-5 m^2/s but at level 10min; other viscosities than 1e-4 at all density ratios",
    "B4": "the sphere's window to 0.03 radii where it is longer than 40 ms (ratios 0.9 to 2)",
    "B4w": "the sphere, and ratios 0.1, 0.9, 1.1 and 20; 5 b/c is longer than its runs",
    "B7": "a start with the piston's speed: it starts under pressure; artificial viscosity is 0.005, its decay not shown",
    "X9": "the pitching tank, a table for regression only: where its axis and its sensors are is not in the data, and a prescribed body turns at a constant speed only",
}
