// The keys of a scene file: one list per struct of scene.h. Reader, printer, schema, help and hash all follow from
// these lists; adding an option is one line here and its use.
//
// What a visitor v understands:
// - v(field, member): a key with a value;
// - v.group(field, list): a key with a map of more keys;
// - v.option(field, form, code, member): a key that sets form = code; options of one struct exclude each other;
// - v.option_group(field, form, code, list): the same with a map of more keys;
// - v.flag(field, form, code): the same with the value true;
// - v.needs_option(what): one of the options has to be there;
// - v.either(field, member, field, member): two numbers that exclude each other; the absent one is 0;
// - v.when(condition, whose, list): keys that only have a use under a condition.
// kReads and kPrints tell reader and printer from the rest. The order of the lines is the order of reading and
// printing.
#pragma once
#include <string>
#include <tuple>

#include "common/scene/field.h"
#include "common/scene/materials.h"

namespace ballast::scene {

template <class V>
void visit(V& v, Box3& b) {
  v({"min", kLength, "lower corner", kAnyNumber, kRequired}, b.min);
  v({"max", kLength, "upper corner", kAnyNumber, kRequired}, b.max);
}

template <class V>
void visit(V& v, Pose& p) {  // also [x, y, z] and [x, y, z, roll, pitch, yaw]
  v({"position", kLength, "of the frame's origin"}, p.position);
  v({"rotation", kAngle, "[roll, pitch, yaw] about fixed axes x, y, z, or a quaternion [w, x, y, z]"}, p.rotation);
}

template <class V>
void visit(V& v, World& w) {
  v({"spacing", kLength, "particle spacing; needed where there is a fluid", kNotNegative}, w.spacing);
  if constexpr (V::kReads) v.state().spacing = w.spacing;  // from here on lengths may be given in spacings
  v({"gravity", kAcceleration, "acceleration of gravity"}, w.gravity);
  v({"dimension", kNone, "3, or 2 for the plane x-z with 1 m of depth", {2, 3}}, w.dimension);
  v({"duration", kTime, "simulated time", kPositive}, w.duration);
  v({"accuracy", kNone, "how much run time accuracy is worth"}, w.accuracy);
  v({"periodic", kNone, "axes along which the domain repeats itself"}, Axes{w.periodic});
  v({"domain", kNone, "where particles may be; by default around everything in the scene"}, w.domain);
  v({"allow_overlap", kNone, "let bodies overlap at the start"}, w.allow_overlap);
  v({"seed", kNone, "of every random draw in the run"}, w.seed);
  v.group({"sleep", kNone, "stop computing where everything has come to rest, until something disturbs it"},
          [&](auto& x) {
            x({"speed", kSpeed, "slower than that is at rest; 0: never sleep", kNotNegative}, w.sleep_speed);
            x({"after", kTime, "at rest before it sleeps", kPositive}, w.sleep_after);
          });
  v.group({"attraction", kNone, "of the fluid towards a point, acceleration rate^2 times the distance"}, [&](auto& a) {
    a({"rate", kFrequency, "in 1/s, written as Hz; 0: none", kNotNegative}, w.attraction_rate);
    a({"centre", kLength, "the point"}, w.attraction_centre);
  });
}

template <class V>
void visit(V& v, Fill& f) {
  auto form = std::tie(f.kind);
  v.option({"box", kNone, "an axis-aligned box"}, form, std::tuple{FillKind::kBox}, f.box);
  v.option_group({"mesh", kNone, "the inside of a closed surface"}, form, std::tuple{FillKind::kMesh}, [&](auto& w) {
    w({"file", kNone, "OBJ, STL or PLY, relative to the scene file", kAnyNumber, kRequired}, MeshFile{f.mesh});
    visit(w, f.pose);
    w({"scale", kNone, "one factor or one per axis", kPositive}, Factors{f.scale});
  });
  v.option_group({"level", kNone, "a container up to a level"}, form, std::tuple{FillKind::kLevel}, [&](auto& w) {
    w({"container", kNone, "open box, hollow shape or mesh around it", kAnyNumber, kRequired}, Name{f.container});
    w({"z", kLength, "height of the surface in the world", kAnyNumber, kRequired}, f.level);
  });
  v.needs_option("where the fluid is");
}

/// Starts a fluid from its preset; without one the density has to be given (check.cpp).
inline void start_from_material(Fluid& f) {
  f.density = 0;
  for (const Material& m : kMaterials) {
    if (m.name == f.material) f.density = m.density, f.viscosity = m.viscosity, f.surface_tension = m.surface_tension;
  }
}

template <class V>
void visit(V& v, Fluid& f) {
  v({"name", kNone, "how other parts of the scene refer to it", kAnyNumber, kRequired}, Name{f.name});
  v({"material", kNone, "preset of the three values below", kAnyNumber, false, kMaterialWords}, f.material);
  if constexpr (!V::kPrints) start_from_material(f);
  v({"density", kDensity, "rest density; needed without a material", kPositive}, f.density);
  v({"viscosity", kViscosity, "dynamic viscosity", kNotNegative}, f.viscosity);
  v({"surface_tension", kSurfaceTension, "against the empty space around it", kNotNegative}, f.surface_tension);
  v({"velocity", kSpeed, "at the start"}, f.velocity);
  v({"angular_velocity", kAngularSpeed, "at the start, about the centre of the fill"}, f.angular_velocity);
  v.group({"vortices", kNone, "Taylor-Green vortices in planes x-z at the start"}, [&](auto& w) {
    w({"speed", kSpeed, "largest"}, f.vortex_speed);
    w({"wavelength", kLength, "after which they repeat", kPositive}, f.vortex_wavelength);
  });
  v({"strain", kFrequency, "at the start, stretching along x, shrinking along z about the fill's centre"}, f.strain);
  v({"fill", kNone, "where it is at the start; solids inside are carved out", kAnyNumber, kRequired}, f.fill);
}

template <class V>
void visit(V& v, Shape& s);

template <class V>
void visit(V& v, Part& p) {
  v({"shape", kNone, "of this part", kAnyNumber, kRequired}, p.shape);
  v({"pose", kNone, "in the model's frame"}, p.pose);
}

template <class V>
void visit(V& v, Shape& s) {
  using enum ShapeKind;
  auto form = std::tie(s.kind, s.hollow);
  auto solid = [](ShapeKind kind) { return std::tuple{kind, false}; };
  auto radius = [&](auto& w) { w({"radius", kLength, "", kPositive, kRequired}, s.radius); };
  auto length = [&](auto& w, auto help) { w({"length", kLength, help, kPositive, kRequired}, s.length); };
  auto wall = [&](auto& w) { w({"wall", kLength, "thickness; 0: three spacings", kNotNegative}, s.wall); };
  v.option({"box", kLength, "full edges; frame at the centre", kPositive}, form, solid(kBox), s.size);
  v.option_group({"sphere", kNone, "frame at the centre"}, form, solid(kSphere), radius);
  v.option_group({"cylinder", kNone, "axis z (y in dimension 2), frame at the centre"}, form, solid(kCylinder),
                 [&](auto& w) {
                   radius(w);
                   length(w, "whole length");
                 });
  v.option_group({"capsule", kNone, "axis z (y in dimension 2), frame at the centre"}, form, solid(kCapsule),
                 [&](auto& w) {
                   radius(w);
                   length(w, "between the centres of the caps");
                 });
  v.option_group({"plane", kNone, "solid half-space through the frame's origin"}, form, solid(kPlane), [&](auto& w) {
    w({"normal", kNone, "unit vector out of the solid"}, Axis{s.normal});
  });
  v.option_group({"open_box", kNone, "tank; frame at the minimum corner of the inside"}, form, solid(kOpenBox),
                 [&](auto& w) {
                   w({"inside", kLength, "inside edges", kPositive, kRequired}, s.size);
                   wall(w);
                   w({"lid", kNone, "closed on top too"}, s.lid);
                 });
  v.option_group({"hollow_sphere", kNone, "container; frame at the centre"}, form, std::tuple{kSphere, true},
                 [&](auto& w) {
                   radius(w);
                   wall(w);
                 });
  v.option_group({"hollow_cylinder", kNone, "container, closed at both ends"}, form, std::tuple{kCylinder, true},
                 [&](auto& w) {
                   radius(w);
                   length(w, "inside length");
                   wall(w);
                 });
  v.option_group(
      {"mesh", kNone, "the inside of a closed surface, in the file's frame"}, form, solid(kMesh), [&](auto& w) {
        w({"file", kNone, "OBJ, STL or PLY, relative to the scene file", kAnyNumber, kRequired}, MeshFile{s.mesh});
        w({"scale", kNone, "one factor or one per axis", kPositive}, Factors{s.scale});
      });
  v.option({"compound", kNone, "several shapes as one solid"}, form, solid(kCompound), s.parts);
  v.needs_option("what the shape is");
}

template <class V>
void visit(V& v, Prescription& p) {
  v({"velocity", kSpeed, "constant"}, p.velocity);
  v({"angular_velocity", kAngularSpeed, "constant"}, p.angular_velocity);
  v({"amplitude", kLength,
     "of a sinusoid in position, amplitude (sin(2 pi frequency (t - start) + phase) - sin(phase))"},
    p.amplitude);
  v({"frequency", kFrequency, "of the sinusoid", kNotNegative}, p.frequency);
  v({"phase", kAngle, "of the sinusoid at the start; 90 deg starts at rest, at the end of the way"}, p.phase);
  v({"start", kTime, "at rest before", kNotNegative}, p.start);
  v({"stop", kTime, "at rest after", kNotNegative}, p.stop);
}

template <class V>
void visit(V& v, Repeat& r) {
  v({"count", kNone, "copies along x, y, z", {1, 10000}, kRequired}, r.count);
  v({"step", kLength, "distance between copies along x, y, z of the world", kAnyNumber, kRequired}, r.step);
}

template <class V>
void visit(V& v, Model& m) {
  auto form = std::tie(m.motion);
  v({"name", kNone, "how other parts of the scene refer to it", kAnyNumber, kRequired}, Name{m.name});
  v.flag({"static", kNone, "never moves"}, form, std::tuple{Motion::kStatic});
  v.option({"prescribed", kNone, "moves as given, whatever acts on it"}, form, std::tuple{Motion::kPrescribed},
           m.prescription);
  v({"shape", kNone, "the solid, in the model's frame", kAnyNumber, kRequired}, m.shape);
  v({"pose", kNone, "of the model's frame in the world"}, m.pose);
  v.when(m.motion == Motion::kDynamic, "models that move freely", [&](auto& w) {
    w.either({"density", kDensity, "of the solid; this or mass", kPositive}, m.density,
             {"mass", kMass, "in dimension 2 per metre of depth; this or density", kPositive}, m.mass);
    w({"velocity", kSpeed, "of the centre of mass at the start"}, m.velocity);
    w({"angular_velocity", kAngularSpeed, "at the start"}, m.angular_velocity);
  });
  v({"friction", kNone, "Coulomb coefficient", kNotNegative}, m.friction);
  v({"restitution", kNone, "speed after over speed before an impact", kFraction}, m.restitution);
  if constexpr (!V::kPrints) {
    Repeat repeat;
    v({"repeat", kNone, "makes copies named name_i_j_k"}, repeat);
    if constexpr (V::kReads) v.state().repeats.push_back(repeat);
  }
}

template <class V>
void visit(V& v, Joint& j) {
  v({"name", kNone, "", kAnyNumber, kRequired}, Name{j.name});
  v({"type", kNone, "", kAnyNumber, kRequired}, j.kind);
  v({"parent", kNone, "model, or world", kAnyNumber, kRequired}, Name{j.parent});
  v({"child", kNone, "model", kAnyNumber, kRequired}, Name{j.child});
  v({"anchor", kLength, "point of the joint in the world at the start"}, j.anchor);
  const bool slides = j.kind == JointKind::kPrismatic, turns = j.kind == JointKind::kRevolute;
  v.when(slides || turns || j.kind == JointKind::kUniversal, "revolute, prismatic and universal joints", [&](auto& w) {
    w({"axis", kNone, "unit vector in the world at the start"}, Axis{j.axis});
  });
  v.when(j.kind == JointKind::kUniversal, "universal joints", [&](auto& w) {
    w({"axis2", kNone, "second axis, unit vector at right angles to the first"}, Axis{j.axis2});
  });
  const Quantity path = slides ? kLength : kAngle, rate = slides ? kSpeed : kAngularSpeed;
  v.when(slides || turns, "revolute and prismatic joints", [&](auto& w) {
    w.group({"limits", kNone, "relative to the start, in m for prismatic joints"}, [&](auto& x) {
      x({"lower", path, ""}, j.lower);
      x({"upper", path, ""}, j.upper);
    });
    w.group({"motor", kNone, "drives the child at a speed, in m/s and N for prismatic joints"}, [&](auto& x) {
      x({"velocity", rate, "wanted"}, j.motor_velocity);
      x({"max_effort", slides ? kForceUnit : kTorque, "at most; 0: no motor", kNotNegative}, j.motor_max_effort);
    });
    w({"spring", slides ? kStiffness : kAngularStiffness, "towards rest, N/m for prismatic joints", kNotNegative},
      j.spring);
    w({"damper", slides ? kDamping : kAngularDamping, "N s/m for prismatic joints", kNotNegative}, j.damper);
    w({"rest", path, "where the spring is at ease"}, j.rest);
  });
}

template <class V>
void visit(V& v, Coupling& c) {
  v({"engine", kNone, "rigid-body engine", kAnyNumber, false, kEngineWords}, c.engine);
  v({"scheme", kNone, "how the two processes share a step", kAnyNumber, false, kSchemeWords}, c.scheme);
  v.when(c.scheme == "iterated", "the iterated scheme (coupling.scheme)", [&](auto& w) {
    w({"tolerance", kNone, "relative interface residual that a step may leave; 0: the accuracy class's", kNotNegative},
      c.tolerance);
    w({"most_iterations", kNone, "exchanges in a step at most", {1, 1000}}, c.most_iterations);
  });
  v({"substeps", kNone, "engine steps per exchange", {1, 100000}}, c.substeps);
  v({"rigid_step", kTime, "step of the engine where no fluid sets it", kPositive}, c.rigid_step);
  v({"contact_sets", kNone,
     "to the engine, where each body touches the fluid; never: nor in messages; auto: to engines started by hand"},
    c.contact_sets);
}

template <class V>
void visit(V& v, Numerics& n) {
  v({"pressure", kNone, "solver"}, n.pressure);
  v({"kernel", kNone, ""}, n.kernel);
  v({"support", kNone, "radius of the kernel in spacings; 0: 2 (cubic), 2.1, 2.9 (wendland)", Range{0, 6}}, n.support);
  v({"sound_speed", kSpeed, "0: ten times the largest speed expected", kNotNegative}, n.sound_speed);
  v.when(n.pressure != Pressure::kImplicit, "the explicit solver (numerics.pressure: wcsph)", [&](auto& w) {
    w({"courant", kNone, "number of the acoustic step; 0: the accuracy class's", kNotNegative}, n.courant);
    w({"diffusion", kNone, "delta-SPH density diffusion (Molteni and Colagrossi 2009)", kNotNegative}, n.diffusion);
  });
  v({"shifting", kNone, "move particles back to even distances; auto: where no weight presses on them"}, n.shifting);
  v({"artificial_viscosity", kNone, "alpha (Monaghan 1992), between particles only", kNotNegative},
    n.artificial_viscosity);
  v({"energy_bound", kNone, "energy gained by the fluid over that at play, beyond which a run has diverged",
     Range{0, 1, true}},
    n.energy_bound);
  v({"relax", kNone, "relax the particles at the start"}, n.relax);
  v({"skip_search", kNone, "keep lists while nothing leaves its cell; false: the same, slower"}, n.skip_search);
  v({"reduced_gravity", kNone,
     "leave out the hydrostatic pressure: buoyancy by Archimedes; for closed containers full of fluid"},
    n.reduced_gravity);
}

template <class V>
void visit(V& v, Probe& p) {
  using enum ProbeKind;
  auto form = std::tie(p.kind);
  v({"name", kNone, "column in probes.csv", kAnyNumber, kRequired}, Name{p.name});
  v.option({"level_at", kLength, "height of the surface above [x, y]; where it is dry, the bottom of the domain"}, form,
           std::tuple{kLevel}, Ground{p.at});
  v.option({"pressure_at", kLength, "pressure at [x, y, z]"}, form, std::tuple{kPressure}, p.at);
  v.option({"velocity_at", kLength, "velocity of the fluid at [x, y, z]"}, form, std::tuple{kVelocity}, p.at);
  const auto of = [&](const char* key, const char* about, ProbeKind kind) {
    v.option({key, kNone, about}, form, std::tuple{kind}, Name{p.target});
  };
  of("force_on", "force and torque of the fluid on a model", kForce);
  of("pose_of", "position and orientation of a model", kPose);
  of("pressure_error", "of a fluid at rest against rho g depth", kPressureError);
  of("motion_of", "momentum and angular momentum (about the origin) of a fluid, its largest speed", kMotion);
  of("void_in", "largest volume that a fluid encloses with no particle of it within a spacing", kVoid);
  v.needs_option("what is measured");
  v.when(p.kind == kLevel || p.kind == kPressure || p.kind == kVelocity, "probes at a place", [&](auto& w) {
    w({"moves_with", kNone, "static or prescribed model in whose frame the place is given"}, Name{p.frame});
  });
}

template <class V>
void visit(V& v, Output& o) {
  v({"every", kTime, "between rows of bodies.csv and probes.csv", kPositive}, o.every);
  v({"vtk", kNone, "ParaView files at every row"}, o.vtk);
  v({"picture", kNone, "picture.png of the last state"}, o.picture);
  v({"camera", kLength, "eye of the picture; all 0: chosen"}, o.camera);
  v({"lcm", kNone, "live messages for monitors over LCM"}, o.lcm);
  v.when(o.lcm, "runs that send messages (output.lcm)", [&](auto& w) {
    w({"lcm_particles", kNone, "in a message frame at most; 0: none", {0, 100000}}, o.lcm_particles);
  });
  v.group({"checkpoint", kNone, "states from which a run can go on (--resume)"}, [&](auto& w) {
    w({"every", kTime, "of simulated time between two; 0: none", kNotNegative}, o.checkpoint_every);
    w({"keep", kNone, "of the newest", {1, 1000}}, o.checkpoint_keep);
  });
}

/// What the values of a column of bodies.csv or probes.csv are; the part behind the last dot says it.
Quantity column_quantity(std::string_view column);

template <class V>
void visit_window(V& v, Expect& e) {
  v({"from", kTime, "samples from then on", kNotNegative}, e.from);
  v({"to", kTime, "samples up to then", kNotNegative}, e.to);
}

template <class V>
void visit_column(V& v, Expect& e) {
  v({"of", kNone, "model.x of bodies.csv, or a column of probes.csv", kAnyNumber, kRequired}, e.column);
  v({"statistic", kNone, "of the samples", kAnyNumber, false, kStatisticWords}, e.statistic);
  visit_window(v, e);
  const Quantity unit = e.statistic == "slope" ? kAnyQuantity : column_quantity(e.column);
  v({"equals", unit, "target; with within"}, e.equals);
  v({"within", unit, "of the target, or in % of it", kNotNegative}, Tolerance{e.within, e.within_relative});
  v({"below", unit, "upper bound"}, e.below);
  v({"above", unit, "lower bound"}, e.above);
}

template <class V>
void visit(V& v, Expect& e) {
  using enum ExpectKind;
  auto form = std::tie(e.kind);
  auto models = [&](auto& w, auto key) { w({key, kNone, "name or pattern with *", kAnyNumber, kRequired}, e.models); };
  v.option({"lost_particles", kNone, "at most, at the end: 0, or a share of all such as 5 %", kFraction}, form,
           std::tuple{kLostParticles}, MostLost{e.equals, e.within_relative});
  v.option_group({"moved", kNone, "models are elsewhere at the end"}, form, std::tuple{kMoved}, [&](auto& w) {
    models(w, "models");
    w({"at_least", kNone, "how many", {1, 1e9}, kRequired}, e.at_least);
    w({"by", kLength, "how far", kPositive, kRequired}, e.by);
  });
  v.option_group({"inside", kNone, "models and particles stay inside a container"}, form, std::tuple{kInside},
                 [&](auto& w) {
                   models(w, "models");
                   w({"container", kNone, "model", kAnyNumber, kRequired}, Name{e.container});
                 });
  v.option_group({"column", kNone, "a statistic of a column"}, form, std::tuple{kColumn},
                 [&](auto& w) { visit_column(w, e); });
  v.option_group(
      {"initial_acceleration", kNone, "of a body let go in a fluid, added mass included"}, form,
      std::tuple{kInitialAcceleration}, [&](auto& w) {
        models(w, "model");
        w({"coefficient", kNone, "added mass per displaced fluid mass", kNotNegative, kRequired}, e.coefficient);
        w({"fluid", kNone, "around it", kAnyNumber, kRequired}, Name{e.fluid});
        w({"within", kNone, "relative, such as 4 %", kPositive, kRequired}, e.within_relative);
        visit_window(w, e);
      });
  v.option_group({"jitter", kNone, "change of acceleration between samples"}, form, std::tuple{kJitter}, [&](auto& w) {
    models(w, "model");
    w({"below", kNone, "in multiples of gravity", kPositive, kRequired}, e.below);
    visit_window(w, e);
  });
  v.option_group({"momentum", kNone, "what bodies got is what the fluid gave"}, form, std::tuple{kMomentum},
                 [&](auto& w) {
                   w({"below", kNone, "relative imbalance", kPositive, kRequired}, e.below);
                 });
  v.option_group({"total_momentum", kNone, "of fluid and bodies together does not drift; without gravity and walls"},
                 form, std::tuple{kTotalMomentum}, [&](auto& w) {
                   w({"below", kNone, "drift over the sum of all momenta at the start", kPositive, kRequired}, e.below);
                 });
  v.option_group({"track", kNone, "a column follows a reference curve"}, form, std::tuple{kTrack}, [&](auto& w) {
    w({"of", kNone, "column, as above", kAnyNumber, kRequired}, e.column);
    w({"reference", kNone, "CSV file (t, value)", kAnyNumber, kRequired}, e.reference);
    w({"time_offset", kTime, "reference time = simulated time - this"}, e.time_offset);
    w({"value_offset", column_quantity(e.column), "reference value = simulated value - this"}, e.value_offset);
    visit_window(w, e);
    w({"below", kAnyQuantity, "bound of the deviation", kPositive, kRequired}, e.below);
  });
  v.needs_option("what is expected");
}

template <class V>
void visit(V& v, Scene& s) {
  int version = 1;
  v({"ballast", kNone, "version of this format", {1, 1}, kRequired}, version);
  v({"description", kNone, "one line for lists of scenes"}, s.description);
  v({"world", kNone, ""}, s.world);
  v({"fluids", kNone, ""}, s.fluids);
  v({"models", kNone, "solids"}, s.models);
  v({"joints", kNone, "between two models, or a model and the world"}, s.joints);
  v({"coupling", kNone, ""}, s.coupling);
  v({"numerics", kNone, "of the fluid"}, s.numerics);
  v({"probes", kNone, "measured at every output time"}, s.probes);
  v({"output", kNone, ""}, s.output);
  v({"expect", kNone, "conditions that make the scene a test"}, s.expects);
}

}  // namespace ballast::scene
