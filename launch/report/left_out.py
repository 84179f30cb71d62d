"""What of the plan cases do without, or judge otherwise than it says: listed on the page, never as passed."""

LEFT_OUT = {
    "all cases": "wall times as medians of three runs: of one, or of as many as --repeats says",
    "F2": "the mean over all particles: velocities at 16 points",
    "F3": "an order of 1.5: shown, not judged; between the finest spacings it is about 0, see its reason",
    "F4": "the fifth period: amplitudes of the first four",
    "B3": "40 spacings per radius at 1e-5 m^2/s but at level 10min; other viscosities than 1e-4 at all density ratios",
    "B4": "a window from 5 b/c = 12.5 ms on: from 2 ms. From 12.5 ms light and neutral bodies start 4.4 to 5.4 % off by the implicit solver at level 1min, where the target is 4 %",
    "B4w": "the sphere, and ratios 0.1, 0.9, 1.1 and 20; 5 b/c is longer than its runs",
    "B7": "a start with the piston's speed: it starts under pressure; artificial viscosity is 0.005, its decay not shown",
    "X2": "the tables with other columns, Koshizuka and Oka's, Buchner's, P3 and P4; the shift in time is not shown",
    "X3": "the free box",
    "X4": "the slamming force",
    "X6": "gravity both ways",
    "X9": "the tables for regression only",
}
