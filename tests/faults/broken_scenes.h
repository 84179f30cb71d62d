// One whole scene, and what is done to it to break it: a text, what stands there instead, and a word of the message.
// The mark ^ is taken out; where it stood, the message must point to.
#pragma once

namespace ballast::testing {

constexpr const char* kWholeScene = R"(ballast: 1
description: A box and a ball in a tank.
world: { dimension: 3, duration: 1 s, spacing: 5 cm, gravity: [0, 0, -9.81], seed: 3 }
fluids:
  - { name: water, material: water, fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } } }
models:
  - { name: tank, static: true, shape: { open_box: { inside: [1, 1, 1] } } }
  - { name: box, shape: { box: [0.2, 0.2, 0.2] }, density: 500 kg/m^3, pose: [0.3, 0.3, 0.7] }
  - { name: ball, shape: { sphere: { radius: 0.1 } }, mass: 2 kg, pose: [0.7, 0.7, 0.7], friction: 0.3 }
joints:
  - { name: pin, type: revolute, parent: world, child: ball, anchor: [0.7, 0.7, 0.9], axis: [0, 1, 0] }
coupling: { engine: ode, scheme: auto, substeps: 1 }
numerics: { pressure: auto, diffusion: 0.1, relax: false }
probes:
  - { name: level, level_at: [0.5, 0.5] }
  - { name: wall, pressure_at: [0.5, 0.5, 0.2] }
output: { every: 20 ms }
expect:
  - { lost_particles: 0 }
  - { column: { of: box.z, statistic: mean, from: 0.5 s, below: 2 m } }
)";

struct Break {
  const char *name, *text, *instead, *word;
};

// clang-format off
constexpr Break kBreaks[] = {
    {"KeyOfTheScene", "output:", "^outputs:", "Did you mean 'output'"},
    {"KeyOfTheWorld", "seed: 3", "^sed: 3", "Did you mean 'seed'"},
    {"KeyOfAFluid", "material: water", "^materiel: water", "Did you mean 'material'"},
    {"KeyOfAFill", "{ box: { min", "{ ^boxx: { min", "Did you mean 'box'"},
    {"KeyOfABox", "max: [1, 1, 0.5]", "^maxx: [1, 1, 0.5]", "Did you mean 'max'"},
    {"KeyOfAModel", "friction: 0.3", "^fiction: 0.3", "Did you mean 'friction'"},
    {"KeyOfAShape", "{ sphere:", "{ ^spehre:", "Did you mean 'sphere'"},
    {"KeyOfASphere", "radius: 0.1", "^diameter: 0.1", "Known here: radius"},
    {"KeyOfAPose", "pose: [0.3, 0.3, 0.7]", "pose: { ^at: [0, 0, 0] }", "position"},
    {"KeyOfAJoint", "anchor:", "^ancor:", "Did you mean 'anchor'"},
    {"KeyOfTheCoupling", "substeps: 1", "^substep: 1", "Did you mean 'substeps'"},
    {"KeyOfTheNumerics", "diffusion: 0.1", "^difusion: 0.1", "Did you mean 'diffusion'"},
    {"KeyOfAProbe", "level_at", "^levels_at", "Did you mean 'level_at'"},
    {"KeyOfTheOutput", "every: 20 ms", "^evry: 20 ms", "Did you mean 'every'"},
    {"KeyOfAnExpectation", "lost_particles: 0", "^lost_particle: 0", "Did you mean 'lost_particles'"},
    {"KeyOfAColumn", "statistic: mean", "^statistics: mean", "Did you mean 'statistic'"},
    {"KeyTwice", "seed: 3", "seed: 3, ^seed: 4", "appears twice"},
    {"KeyWithoutEffect", "static: true,", "static: true, ^mass: 3,", "only for"},
    {"KeysThatExclude", "mass: 2 kg", "mass: 2 kg, density: 100", "exclude each other"},
    {"ShapeTwice", "shape: { sphere: { radius: 0.1 } }", "shape: { sphere: { radius: 0.1 }, box: [1, 1, 1] }", "exclude each other"},
    {"MissingName", "- { name: ball, shape", "- ^{ shape", "'name' is missing"},
    {"MissingShape", "name: box, shape: { box: [0.2, 0.2, 0.2] }", "name: box", "'shape' is missing"},
    {"MissingRadius", "sphere: { radius: 0.1 }", "sphere: ^{}", "'radius' is missing"},
    {"NoMass", ", mass: 2 kg", "", "neither density nor mass"},
    {"NoValue", "seed: 3", "^seed:", "has no value"},
    {"WordForANumber", "spacing: 5 cm", "spacing: ^fine", "is not a number"},
    {"ListForANumber", "spacing: 5 cm", "spacing: ^[1, 2]", "is a list"},
    {"MapForAList", "gravity: [0, 0, -9.81]", "gravity: ^{ z: -9.81 }", "a list is needed"},
    {"NumberForAMap", "output: { every: 20 ms }", "output: ^20 ms", "a map is needed"},
    {"NumberForAFlag", "relax: false", "relax: ^0", "true, false"},
    {"TwoForThree", "gravity: [0, 0, -9.81]", "gravity: ^[0, -9.81]", "3 are needed"},
    {"FractionForAnInteger", "substeps: 1", "substeps: ^1.5", "whole number"},
    {"SecondsForMetres", "spacing: 5 cm", "spacing: ^5 s", "is a time"},
    {"MetresForADensity", "density: 500 kg/m^3", "density: ^500 m", "is a length"},
    {"UnknownUnit", "spacing: 5 cm", "spacing: ^5 parsec", "parsec"},
    {"KgForADensity", "density: 500 kg/m^3", "density: ^500 kg", "is a mass"},
    {"TwoNumbers", "duration: 1 s", "duration: ^1 2 s", "the unit"},
    {"CommaForAPoint", "mass: 2 kg", "mass: ^'2,5 kg'", "the unit"},
    {"NotANumber", "mass: 2 kg", "mass: ^.nan", "not a number"},
    {"Infinity", "duration: 1 s", "duration: ^.inf", "not a number"},
    {"NanInAVector", "pose: [0.3, 0.3, 0.7]", "pose: [0.3, ^nan, 0.7]", "finite"},
    {"TooLargeForADouble", "mass: 2 kg", "mass: ^1e999 kg", "outside the range"},
    {"UnknownEngine", "engine: ode", "engine: ^bullet", "ode"},
    {"UnknownScheme", "scheme: auto", "scheme: ^autto", "Did you mean 'auto'"},
    {"UnknownMaterial", "material: water", "material: ^watr", "Did you mean 'water'"},
    {"UnknownJoint", "type: revolute", "type: ^hinge", "revolute"},
    {"UnknownStatistic", "statistic: mean", "statistic: ^average", "mean"},
    {"NameWithABlank", "name: box", "name: ^my box", "letters, digits"},
    {"FormatOfTheFuture", "ballast: 1", "ballast: ^2", "out of range"},
    {"NoSpacing", "spacing: 5 cm,", "", "spacing"},
    {"NegativeSpacing", "spacing: 5 cm", "spacing: ^-5 cm", "at least 0"},
    {"ZeroDuration", "duration: 1 s", "duration: ^0 s", "greater than 0"},
    {"FourDimensions", "dimension: 3", "dimension: ^4", "from 2 to 3"},
    {"NegativeMass", "mass: 2 kg", "mass: ^-2 kg", "greater than 0"},
    {"NegativeDensity", "density: 500 kg/m^3", "density: ^-500", "greater than 0"},
    {"NegativeRadius", "radius: 0.1", "radius: ^-0.1", "greater than 0"},
    {"NegativeFriction", "friction: 0.3", "friction: ^-0.3", "at least 0"},
    {"RestitutionAboveOne", "friction: 0.3", "restitution: ^1.5", "from 0 to 1"},
    {"FlatBox", "box: [0.2, 0.2, 0.2]", "box: [0.2, ^0, 0.2]", "greater than 0"},
    {"ZeroSubsteps", "substeps: 1", "substeps: ^0", "from 1"},
    {"NegativeSeed", "seed: 3", "seed: ^-3", "whole number"},
    {"LostParticlesExpected", "lost_particles: 0", "lost_particles: ^5", "Write lost_particles: 0"},
    {"LostParticlesBeyondAll", "lost_particles: 0", "lost_particles: ^120 %", "from 0 to 1"},
    {"AbsurdDensity", "density: 500 kg/m^3", "density: ^1e300", "is the unit right?"},
    {"AbsurdFluidDensity", "material: water", "material: water, density: ^1e300", "is the unit right?"},
    {"AbsurdPlace", "pose: [0.3, 0.3, 0.7]", "pose: [^1e30, 0.3, 0.7]", "is the unit right?"},
    {"AbsurdMass", "mass: 2 kg", "mass: ^1e200 kg", "is the unit right?"},
    {"AbsurdSize", "box: [0.2, 0.2, 0.2]", "box: [^1e20, 0.2, 0.2]", "is the unit right?"},
    {"AbsurdlySmall", "radius: 0.1", "radius: ^1e-200", "is the unit right?"},
    {"AbsurdGravity", "-9.81", "^-1e40", "is the unit right?"},
    {"AbsurdDuration", "duration: 1 s", "duration: ^1e100 s", "is the unit right?"},
    {"AbsurdSpeed", "friction: 0.3", "velocity: [^1e20, 0, 0]", "is the unit right?"},
    {"AbsurdViscosity", "material: water", "material: water, viscosity: ^1e100", "is the unit right?"},
    {"CoarseSpacing", "spacing: 5 cm", "spacing: 50 m", "less than a particle"},
    {"CoarseSpacingForTheFill", "spacing: 5 cm", "spacing: 40 cm", "too few to flow"},
    {"FineSpacing", "spacing: 5 cm", "spacing: ^1 um", "um"},
    {"TinyStep", "substeps: 1", "rigid_step: ^1e-30 s", "is the unit right?"},
    {"TinyOutput", "every: 20 ms", "every: ^1e-30 s", "is the unit right?"},
    {"TwoModelsOfOneName", "name: ball, shape", "name: ^box, shape", "exists already"},
    {"TwoProbesOfOneName", "name: wall", "name: ^level", "exists already"},
    {"TwoFluidsOfOneName", "models:", "  - { name: ^water, material: sea_water, fill: { box: { min: [0, 0, 0.5], max: [1, 1, 0.6] } } }\nmodels:", "exists already"},
    {"ModelNamedWorld", "name: box", "name: ^world", "Choose another"},
    {"FillUpsideDown", "min: [0, 0, 0], max: [1, 1, 0.5]", "min: [0, 0, 0.6], max: [1, 1, 0.5]", "empty along z"},
    {"FillInsideTheWall", "min: [0, 0, 0], max: [1, 1, 0.5]", "min: [-0.15, 0, 0], max: [-0.05, 1, 0.5]", "less than a particle"},
    {"FillInAnUnknownContainer", "fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } }", "fill: { level: { container: ^tonk, z: 0.5 } }", "Did you mean 'tank'"},
    {"LevelAboveTheRim", "fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } }", "fill: { level: { container: tank, z: 1.5 } }", "above the rim of 'tank' at z = 1 m"},
    {"AcrossAPeriodicBorder", "seed: 3", "seed: 3, periodic: [x], domain: { min: [0.25, 0, 0], max: [1.25, 1, 1] }", "across the periodic border at 0.25 m"},
    {"FillInABox", "fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } }", "fill: { level: { container: ^box, z: 0.5 } }", "open_box"},
    {"FillBelowTheContainer", "fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } }", "fill: { level: { container: tank, z: -3 } }", "less than a particle"},
    {"FillMeshMissing", "fill: { box: { min: [0, 0, 0], max: [1, 1, 0.5] } }", "fill: { mesh: { file: ^none.obj } }", "none.obj"},
    {"OverlappingFluids", "models:", "  - { name: oil, material: sea_water, fill: { box: { min: [0, 0, 0.3], max: [1, 1, 0.6] } } }\nmodels:", "overlap"},
    {"FluidInALevelFill", "models:", "  - ^{ name: oil, material: sea_water, fill: { level: { container: tank, z: 0.2 } } }\nmodels:", "overlap"},
    {"EngineWithoutJoints", "  - { name: pin, type: revolute, parent: world, child: ball, anchor: [0.7, 0.7, 0.9], axis: [0, 1, 0] }\ncoupling: { engine: ode, scheme", "  - ^{ name: pin, type: revolute, parent: world, child: ball, anchor: [0.7, 0.7, 0.9], axis: [0, 1, 0] }\ncoupling: { engine: free_body, scheme", "has no joints"},
    {"StartBeyondALimit", "axis: [0, 1, 0] }", "axis: [0, 1, 0], limits: ^{ lower: 0.5, upper: 1 } }", "leave the start itself out"},
    {"OverlappingBodies", "pose: [0.7, 0.7, 0.7]", "pose: [0.35, 0.35, 0.75]", "overlap"},
    {"BodyInTheWall", "pose: [0.3, 0.3, 0.7]", "pose: [0, 0.3, 0.7]", "overlap"},
    {"MeshMissing", "box: [0.2, 0.2, 0.2]", "mesh: { file: ^nowhere.obj }", "nowhere.obj"},
    {"MeshIsAFolder", "box: [0.2, 0.2, 0.2]", "mesh: { file: ^folder.obj }", "folder.obj"},
    {"MeshIsNone", "box: [0.2, 0.2, 0.2]", "mesh: { file: broken.yaml }", "broken.yaml"},
    {"MeshIsEmpty", "box: [0.2, 0.2, 0.2]", "mesh: { file: empty.obj }", "empty.obj"},
    {"MeshIsOpen", "box: [0.2, 0.2, 0.2]", "mesh: { file: open.obj }", "open.obj"},
    {"EmptyCompound", "box: [0.2, 0.2, 0.2]", "compound: []", "no parts"},
    {"JointToNobody", "child: ball", "child: ^bull", "Did you mean 'ball'"},
    {"JointToItself", "parent: world", "parent: ball", "itself"},
    {"JointParentUnknown", "parent: world", "parent: ^word", "Did you mean 'world'"},
    {"JointOfTheTank", "child: ball", "child: tank", "neither side"},
    {"AxisTooLong", "axis: [0, 1, 0]", "axis: ^[0, 2, 0]", "Write axis: [0, 1, 0]"},
    {"AxisOfNoLength", "axis: [0, 1, 0]", "axis: ^[0, 0, 0]", "unit vector"},
    {"LimitsCrossed", "axis: [0, 1, 0]", "axis: [0, 1, 0], limits: { lower: 1, upper: -1 }", "below the upper limit"},
    {"MotorWithoutEffort", "axis: [0, 1, 0]", "axis: [0, 1, 0], motor: { velocity: 1 }", "max_effort"},
    {"RepeatOnThePlace", "friction: 0.3", "repeat: { count: [2, 1, 1], step: [0, 0, 0] }", "lie at one place"},
    {"RepeatWithoutEnd", "friction: 0.3", "repeat: { count: [10000, 10000, 1], step: [1, 1, 1] }", "more than"},
    {"OscillationWithoutFrequency", "mass: 2 kg", "prescribed: { amplitude: [0.1, 0, 0] }", "frequency"},
    {"EmptyDomain", "seed: 3", "domain: { min: [1, 0, 0], max: [0, 1, 1] }", "empty along x"},
    {"PeriodicWithoutDomain", "seed: 3", "periodic: [x]", "domain"},
    {"DomainWithoutTheFluid", "seed: 3", "domain: { min: [5, 5, 5], max: [6, 6, 6] }", "outside world.domain"},
    {"DomainShorterThanTheFill", "seed: 3", "domain: { min: [-0.5, -0.5, -0.5], max: [0.5, 1.5, 1.5] }", "outside world.domain"},
    {"PeriodicTooShort", "seed: 3", "domain: { min: [0, 0, 0], max: [0.2, 1, 1] }, periodic: [x]", "periodic axis x"},
    {"RotationOutOfThePlane", "dimension: 3", "dimension: 2", "the plane is x-z"},
    {"LevelOutside", "level_at: [0.5, 0.5]", "level_at: [5, 0.5]", "where no fluid can be"},
    {"PressureOutside", "pressure_at: [0.5, 0.5, 0.2]", "pressure_at: [0.5, 0.5, -3]", "where no fluid can be"},
    {"PressureInTheWall", "pressure_at: [0.5, 0.5, 0.2]", "pressure_at: [0.5, 0.5, -0.12]", "tank"},
    {"ForceOnNobody", "level_at: [0.5, 0.5]", "force_on: ^bux", "Did you mean 'box'"},
    {"ErrorOfNoFluid", "level_at: [0.5, 0.5]", "pressure_error: ^oil", "water"},
    {"ColumnOfNobody", "of: box.z", "of: ^bix.z", "box"},
    {"ColumnOfTheTank", "of: box.z", "of: ^tank.z", "static"},
    {"ColumnWithoutPart", "of: box.z", "of: ^box.q", "box."},
    {"ColumnWithoutBound", ", below: 2 m", "", "below"},
    {"NothingBetween", "below: 2 m", "below: 2 m, above: 3 m", "nothing is above"},
    {"WindowAfterTheRun", "from: 0.5 s", "from: ^1.5 s", "duration"},
    {"WindowBeyondTheRun", "from: 0.5 s", "from: 0.5 s, to: ^1.5 s", "duration"},
    {"WindowBackwards", "from: 0.5 s", "from: 0.5 s, to: 0.2 s", "no sample"},
    {"NobodyMoves", "lost_particles: 0", "moved: { models: ^'crate*', at_least: 1, by: 1 m }", "no model matches"},
    {"TooManyMove", "lost_particles: 0", "moved: { models: 'b*', at_least: ^5, by: 1 m }", "at most 2"},
    {"InsideABox", "lost_particles: 0", "inside: { models: ball, container: ^box }", "no inside"},
    {"TotalMomentumWithGravity", "lost_particles: 0", "total_momentum: { below: 1 }", "gravity"},
};
// clang-format on

}  // namespace ballast::testing
