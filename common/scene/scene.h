// The scene as every part of Ballast sees it: checked, in SI units, z up. In dimension 2 the plane is x-z and the
// depth along y is 1 m, so that masses are per metre of depth.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ballast {

using Vec3 = Eigen::Vector3d;
using Quat = Eigen::Quaterniond;

/// Position and orientation: x_world = position + rotation * x_local.
struct Pose {
  Vec3 position = Vec3::Zero();      ///< m
  Quat rotation = Quat::Identity();  ///< unit quaternion
};

/// Axis-aligned box, min < max in every axis.
struct Box3 {
  Vec3 min = Vec3::Zero();  ///< m
  Vec3 max = Vec3::Zero();  ///< m
};

/// Where in a scene file a value was written; line and column count from 1; line 0 means "not from a file".
struct Place {
  std::string file;
  int line = 0, column = 0;
};

enum class Accuracy { kInteractive, kBalanced, kAccurate };

struct World {
  Vec3 gravity{0, 0, -9.81};  ///< m/s^2
  int dimension = 3;          ///< 2 (plane x-z) or 3
  double duration = 1;        ///< s, simulated
  double spacing = 0;         ///< m, particle spacing d
  Accuracy accuracy = Accuracy::kBalanced;
  std::array<bool, 3> periodic{};  ///< per axis; needs `domain`
  std::optional<Box3> domain;      ///< where particles may be; default: around everything in the scene
  bool allow_overlap = false;      ///< let bodies overlap at the start
  std::uint64_t seed = 1;          ///< of every random draw in the run
  double sleep_speed = 0;          ///< m/s: slower than that is at rest; 0: a run never sleeps
  double sleep_after = 0.5;        ///< s at rest before steps are slept through
  /// A field of force on the fluid: acceleration -rate^2 (x - centre), in dimension 2 within the plane.
  double attraction_rate = 0;  ///< 1/s
  Vec3 attraction_centre = Vec3::Zero();
};

enum class FillKind { kBox, kMesh, kLevel };

/// Where a fluid is at the start; the volume of bodies inside it is carved out.
struct Fill {
  FillKind kind = FillKind::kBox;
  Box3 box;                   ///< kBox: this box. In dimension 2 its y extent is ignored
  std::string mesh;           ///< kMesh: file of a closed surface
  Pose pose;                  ///< kMesh
  Vec3 scale = Vec3::Ones();  ///< kMesh
  std::string
      container;     ///< kLevel: model (open box, sphere, cylinder used as container, or mesh) that holds the fluid
  double level = 0;  ///< kLevel: z of the surface in world coordinates, m
};

struct Fluid {
  std::string name = "water";
  std::string material;                  ///< preset it came from, or empty
  double density = 1000;                 ///< rest density, kg/m^3
  double viscosity = 0;                  ///< dynamic, Pa s
  double surface_tension = 0;            ///< N/m
  Vec3 velocity = Vec3::Zero();          ///< m/s at the start
  Vec3 angular_velocity = Vec3::Zero();  ///< rad/s, rigid rotation about the centre of the fill at the start
  /// Taylor-Green vortices at the start, added to both: v += speed [-cos(kx) sin(kz), 0, sin(kx) cos(kz)] at the place
  /// [x, y, z] in the world, k = 2 pi / wavelength.
  double vortex_speed = 0;       ///< m/s
  double vortex_wavelength = 1;  ///< m
  double strain = 0;             ///< 1/s: v += strain [x, 0, -z] about the centre of the fill at the start, no rotation
  Fill fill;
  Place place;
};

enum class ShapeKind { kBox, kSphere, kCylinder, kCapsule, kPlane, kOpenBox, kMesh, kCompound };

struct Shape;

/// One part of a compound: a shape at a pose in the model's frame.
struct Part;

/// A solid in its own frame. Its axis is z for cylinder and capsule, y for both in dimension 2 (discs).
struct Shape {
  ShapeKind kind = ShapeKind::kBox;
  Vec3 size = Vec3::Zero();   ///< kBox: full edges; kOpenBox: inside edges, m
  double radius = 0;          ///< kSphere, kCylinder, kCapsule, m
  double length = 0;          ///< kCylinder: whole length; kCapsule: between the cap centres, m
  Vec3 normal{0, 0, 1};       ///< kPlane: solid lies on the side opposite to it
  double wall = 0;            ///< kOpenBox: wall thickness, m (0: three spacings)
  bool lid = false;           ///< kOpenBox: closed on top too
  bool hollow = false;        ///< kSphere, kCylinder: a container: solid outside the radius, `wall` thick
  std::string mesh;           ///< kMesh: file of a closed surface
  Vec3 scale = Vec3::Ones();  ///< kMesh
  std::vector<Part> parts;    ///< kCompound
};

struct Part {
  Shape shape;
  Pose pose;
};

enum class Motion { kStatic, kDynamic, kPrescribed };

/// Motion of a prescribed body: at rest before `start` and after `stop`, else constant twist plus a sinusoid in
/// position: amplitude * (sin(2 pi frequency (t - start) + phase) - sin(phase)), from the pose on.
struct Prescription {
  Vec3 velocity = Vec3::Zero();          ///< m/s
  Vec3 angular_velocity = Vec3::Zero();  ///< rad/s
  Vec3 amplitude = Vec3::Zero();         ///< m
  double frequency = 0;                  ///< Hz
  double phase = 0;                      ///< rad; a quarter turn starts at rest
  double start = 0;                      ///< s
  double stop = 1e300;                   ///< s
};

/// One solid. `repeat` in a scene file has already been expanded into names "crate_0_0_0", ...
struct Model {
  std::string name;
  Motion motion = Motion::kDynamic;
  Shape shape;
  Pose pose;              ///< of the model's frame in the world at t = 0
  double density = 0;     ///< kg/m^3; kDynamic: density or mass, the other is 0
  double mass = 0;        ///< kg (kg per metre of depth in dimension 2)
  double friction = 0.3;  ///< Coulomb coefficient
  double restitution = 0.1;
  Vec3 velocity = Vec3::Zero();          ///< m/s, of the centre of mass at t = 0
  Vec3 angular_velocity = Vec3::Zero();  ///< rad/s
  Prescription prescription;             ///< kPrescribed only
  Place place;
};

enum class JointKind { kFixed, kRevolute, kPrismatic, kBall, kUniversal };

struct Joint {
  std::string name;
  JointKind kind = JointKind::kFixed;
  std::string parent;                  ///< model name, or "world"
  std::string child;                   ///< model name
  Vec3 anchor = Vec3::Zero();          ///< m, world, at t = 0
  Vec3 axis{0, 0, 1};                  ///< unit, world, at t = 0
  Vec3 axis2{1, 0, 0};                 ///< kUniversal: second axis, unit, orthogonal to axis
  std::optional<double> lower, upper;  ///< rad or m, relative to the start
  double motor_velocity = 0;           ///< rad/s or m/s
  double motor_max_effort = 0;         ///< N m or N; 0: no motor
  double spring = 0;                   ///< N m/rad or N/m, towards `rest`
  double damper = 0;                   ///< N m s/rad or N s/m
  double rest = 0;                     ///< rad or m
  Place place;
};

/// When an optional part of a run is there. kAuto: by a stated rule.
enum class When { kAuto, kAlways, kNever };

struct Coupling {
  std::string engine = "ode";       ///< ode, free_body
  std::string scheme = "auto";      ///< auto, interlinked, iterated, staggered
  double tolerance = 0;             ///< iterated: relative interface residual a step may leave; 0: the accuracy class's
  int most_iterations = 20;         ///< iterated: exchanges in a step
  int substeps = 1;                 ///< engine steps per exchange
  double rigid_step = 1e-3;         ///< s, step of the engine where no fluid sets it
  When contact_sets = When::kAuto;  ///< with the wrenches, where each body touches the fluid
};

enum class Pressure { kAuto, kWcsph, kImplicit };
enum class KernelKind { kAuto, kCubic, kWendland };

struct Numerics {
  Pressure pressure = Pressure::kAuto;
  KernelKind kernel = KernelKind::kAuto;
  double support = 0;                  ///< radius of the kernel, spacings; 0: 2 (cubic), 2.1 or 2.9 (Wendland)
  double sound_speed = 0;              ///< m/s; 0: ten times the largest speed expected
  double courant = 0;                  ///< of the acoustic step; 0: the accuracy class's
  double diffusion = 0.1;              ///< delta-SPH density diffusion (Molteni and Colagrossi 2009)
  When shifting = When::kAuto;         ///< move particles back to even distances
  double artificial_viscosity = 0.02;  ///< alpha (Monaghan 1992), between particles only
  double energy_bound = 0.1;           ///< energy gained over the energy at play: beyond it a run has diverged
  bool relax = true;                   ///< relax the particles at the start
  bool skip_search = true;             ///< keep order and neighbour lists while nothing leaves its cell
  /// The hydrostatic part of the pressure is left out: the fluid feels no gravity, every body the buoyancy of
  /// Archimedes instead. The same motion where the fluid fills a closed container; wrong where it has a surface.
  bool reduced_gravity = false;
};

enum class ProbeKind { kLevel, kPressure, kVelocity, kForce, kPose, kPressureError, kMotion, kVoid };

/// Something measured at every output time. Columns in probes.csv:
/// kLevel "name" (m; the bottom of the domain where it is dry); kPressure "name" (Pa); kVelocity "name.vx/vy/vz" (m/s);
/// kForce "name.fx/fy/fz/tx/ty/tz" (N, N m, of the fluid on the model, torque about its centre of mass, or about its
/// frame's origin if it is static); kPose "name.x/y/z/qw/qx/qy/qz"; kPressureError "name": L2 over the fluid's
/// particles of p - rho g (level - z), over rho g depth; kMotion "name.px/py/pz/lx/ly/lz/fastest": momentum (kg m/s)
/// and angular momentum about the origin (kg m^2/s) of a fluid, its largest speed (m/s); kVoid "name": largest volume
/// (m^3) that a fluid encloses with no particle of it within a spacing.
struct Probe {
  std::string name;
  ProbeKind kind = ProbeKind::kLevel;
  Vec3 at = Vec3::Zero();  ///< kLevel (x, y), kPressure and kVelocity (x, y, z), m
  std::string target;      ///< kForce, kPose: model; kPressureError, kMotion, kVoid: fluid
  std::string frame;       ///< model in whose frame `at` is given, static or prescribed; empty: the world's
  Place place;
};

struct Output {
  double every = 0.02;          ///< s between rows of bodies.csv and probes.csv
  bool vtk = false;             ///< ParaView files at every row
  bool picture = false;         ///< picture.png of the last state
  bool lcm = false;             ///< live messages for monitors over LCM
  int lcm_particles = 5000;     ///< particles in a message frame at most; 0: none
  Vec3 camera = Vec3::Zero();   ///< eye position for the picture, m; zero: chosen
  double checkpoint_every = 0;  ///< s between checkpoints; 0: none
  int checkpoint_keep = 2;      ///< newest ones that are kept
};

enum class ExpectKind {
  kLostParticles,
  kMoved,
  kInside,
  kColumn,
  kInitialAcceleration,
  kJitter,
  kMomentum,
  kTotalMomentum,
  kTrack
};

/// One condition that makes the scene a test.
struct Expect {
  ExpectKind kind = ExpectKind::kColumn;
  std::string models;     ///< name or pattern with * : kMoved, kInside, kInitialAcceleration, kJitter
  std::string container;  ///< kInside: model whose inside must hold the models and all particles
  std::string column;     ///< kColumn: "model.x" .. of bodies.csv or a column of probes.csv
  std::string statistic =
      "last";  ///< kColumn: last, mean, min, max, max_abs, rms (about the mean), change (last - first), slope
  double from = 0, to = 1e300;            ///< s, window of the samples used
  std::optional<double> equals;           ///< target value; with `within`
  std::optional<double> within;           ///< absolute tolerance (SI)
  std::optional<double> within_relative;  ///< relative tolerance, from "within: 4 %"
  std::optional<double> below, above;     ///< bounds
  int at_least = 0;                       ///< kMoved: how many models
  double by = 0;                          ///< kMoved: how far, m
  double coefficient = 0;                 ///< kInitialAcceleration: added mass per displaced fluid mass
  std::string fluid;                      ///< kInitialAcceleration: the fluid around it
  std::string reference;                  ///< kTrack: CSV file (t, value), relative to the references folder
  double time_offset = 0;                 ///< kTrack: reference time = simulated time - time_offset, s
  double value_offset = 0;                ///< kTrack: reference value = simulated value - value_offset
  Place place;
};

struct Scene {
  std::string name;  ///< file name without folder and ending
  std::string description;
  World world;
  std::vector<Fluid> fluids;
  std::vector<Model> models;
  std::vector<Joint> joints;
  Coupling coupling;
  Numerics numerics;
  std::vector<Probe> probes;
  Output output;
  std::vector<Expect> expects;
};

}  // namespace ballast
