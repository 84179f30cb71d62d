// Every record in shared memory. Fixed-width, trivially copyable, no pointers, sizes asserted. A change bumps
// kProtocolVersion. SI units, world frame, wrenches and twists about the centre of mass, unless a comment says
// otherwise.
#pragma once
#include <array>
#include <cstdint>
#include <type_traits>

namespace ballast::exchange {

inline constexpr std::uint64_t kMagic = 0x3154534c4c41420aULL;  // "\nBALLST1", little endian
inline constexpr std::uint32_t kProtocolVersion = 7;

enum class BodyMotion : std::uint32_t { kStatic = 0, kDynamic = 1, kPrescribed = 2 };
enum class ShapeType : std::uint32_t { kBox = 0, kSphere = 1, kCylinder = 2, kCapsule = 3, kPlane = 4, kMesh = 5 };
enum class JointType : std::uint32_t { kFixed = 0, kRevolute = 1, kPrismatic = 2, kBall = 3, kUniversal = 4 };

/// World-wide facts of the manifest.
struct WorldRecord {
  double gravity[3];        ///< m/s^2
  double duration;          ///< s
  double rigid_step;        ///< s, engine step where no fluid sets it
  double length_scale;      ///< m, typical body size, for contact tolerances
  std::uint32_t dimension;  ///< 2 (plane x-z) or 3
  std::uint32_t substeps;   ///< engine steps per exchange
  std::uint64_t seed;
  double output_every;  ///< s between rows of bodies; 0: every step
  double sleep_speed;   ///< m/s: where nothing is faster for sleep_after, steps are slept through; 0: never
  double sleep_after;   ///< s
};
static_assert(sizeof(WorldRecord) == 88);

/// One body; its frame has its origin at the centre of mass (static and prescribed: at the model's origin).
struct BodyRecord {
  char name[64];               ///< zero-terminated
  double mass;                 ///< kg (dynamic only)
  double inertia[6];           ///< xx yy zz xy xz yz about the centre of mass, body axes, kg m^2
  double position[3];          ///< m, at t = 0
  double orientation[4];       ///< w x y z
  double velocity[3];          ///< m/s
  double angular_velocity[3];  ///< rad/s
  double friction, restitution;
  double volume;  ///< m^3
  // prescribed motion: constant twist and sinusoid between start and stop, see scene.h
  double drive_velocity[3], drive_angular_velocity[3], drive_amplitude[3], drive_frequency, drive_phase, drive_start,
      drive_stop;
  BodyMotion motion;
  std::uint32_t first_shape, shape_count;
  std::uint32_t reserved;
};
static_assert(sizeof(BodyRecord) == 64 + 8 * (1 + 6 + 3 + 4 + 3 + 3 + 3 + 13) + 16);

/// One convex or mesh part of a body, posed in the body frame. Containers appear as their walls (boxes) or as meshes.
struct ShapeRecord {
  ShapeType type;
  std::uint32_t body;
  double position[3];     ///< m, body frame
  double orientation[4];  ///< w x y z
  double size[3];         ///< kBox: full edges, m
  double radius, length;  ///< m; axis z of the shape's own frame; capsule: between cap centres
  double normal[3];       ///< kPlane: body frame, solid on the other side
  std::uint32_t first_vertex, vertex_count, first_triangle, triangle_count;  ///< kMesh
};
static_assert(sizeof(ShapeRecord) == 8 + 8 * 15 + 16);

struct JointRecord {
  char name[64];
  double anchor[3], axis[3], axis2[3];  ///< world, at t = 0
  double lower, upper;                  ///< rad or m; -inf / +inf where free
  double motor_velocity, motor_max_effort;
  double spring, damper, rest;
  JointType type;
  std::int32_t parent, child;  ///< body index; -1: world
  std::uint32_t reserved;
};
static_assert(sizeof(JointRecord) == 64 + 8 * 16 + 16);

/// State of one body at the end of a step, rigid -> fluid.
struct BodyState {
  double position[3];           ///< m, of the body frame's origin (dynamic: centre of mass)
  double orientation[4];        ///< w x y z, unit
  double velocity[3];           ///< m/s
  double angular_velocity[3];   ///< rad/s
  double acceleration[6];       ///< linear, angular: change of twist over the last step / Dt
  double free_acceleration[6];  ///< of the twist without any wrench from the fluid; free motion = twist + Dt * this.
                                ///< With the reactions of contacts and joints in the last step, without impacts
  double mobility[36];  ///< row-major 6x6, (linear, angular): change of twist per impulse wrench; 0 if prescribed
};
static_assert(sizeof(BodyState) == 8 * 61);

/// Wrench of the fluid on one body, mean over the step, fluid -> rigid.
struct Wrench {
  double force[3];   ///< N
  double torque[3];  ///< N m, about the centre of mass
};
static_assert(sizeof(Wrench) == 48);

/// Where the fluid touches a body: a patch of its surface.
struct Contact {
  std::uint32_t body;
  std::uint32_t samples;  ///< wetted samples merged into this patch
  double position[3];     ///< m, world, where `force` acts
  double normal[3];       ///< unit, out of the solid
  double force[3];        ///< N, on the body
  double depth;           ///< m, how far the deepest fluid particle's edge reaches below the surface (negative: gap)
  double area;            ///< m^2
};
static_assert(sizeof(Contact) == 8 + 8 * 11);

enum class CommandKind : std::uint32_t { kWrench = 1, kPose = 2, kGravity = 3 };

/// What someone outside changes at the border of a step: coordinator -> the process that begins steps -> rigid.
struct Command {
  std::uint64_t id;    ///< from 1, in the order of sending
  std::uint64_t step;  ///< takes effect at the end of this step (a replay); 0: of the next one to begin
  CommandKind kind;
  std::uint32_t body;  ///< index; kGravity: 0
  double values[7];    ///< kWrench: force, N, torque, N m; kPose: position, m, w x y z; kGravity: m/s^2; else 0
  double duration;     ///< kWrench: s; acts on all steps that begin before its end, on one at least
};
static_assert(sizeof(Command) == 24 + 8 * 8);
inline constexpr std::uint32_t kMostCommands = 8;  ///< in one order; further ones wait for the next

/// Heads the answer to a command, process -> coordinator; the reason follows as UTF-8 text where it was refused.
struct CommandResult {
  std::uint64_t id;
  std::uint32_t refused;  ///< 0: it took effect at the end of the frame's step
  std::uint32_t reserved;
};
static_assert(sizeof(CommandResult) == 16);

enum OrderFlag : std::uint32_t {
  kLast = 1u,      ///< no step follows
  kRollBack = 2u,  ///< first restore the state before `step`, then apply this order
  kEnd = 4u,       ///< never sent: RigidLink::receive() says so that the fluid process finished after `step`
  kAsleep = 8u,    ///< the engine does not step: all bodies stay as they are
};

/// Heads every message fluid -> rigid.
struct Order {
  std::uint64_t step;       ///< counts from 1: this message moves the bodies from state step - 1 to state step
  std::uint32_t iteration;  ///< of this step, from 0
  std::uint32_t flags;      ///< OrderFlag
  double time;              ///< s, at the start of the step
  double dt;                ///< s, length of the step
  double next_dt;           ///< s, bound on the next step, from the fluid
  std::uint32_t bodies;     ///< wrenches that follow: must equal the manifest's dynamic + prescribed + static bodies
  std::uint32_t contacts;   ///< contacts put into the ring for this step
  std::uint64_t contacts_lost;  ///< patches merged because the ring was full
  std::uint32_t commands;       ///< that take effect at the end of this step, behind the wrenches
  std::uint32_t reserved;
};
static_assert(sizeof(Order) == 64);

/// Heads every message rigid -> fluid.
struct Answer {
  std::uint64_t step;  ///< the step just finished; 0: the initial state
  std::uint32_t iteration;
  std::uint32_t bodies;
  double time;         ///< s, at the end of the step
  double max_dt;       ///< s, bound on the next step, from the engine
  std::uint64_t hash;  ///< state hash of the bodies
  std::uint32_t flags, reserved;
};
static_assert(sizeof(Answer) == 48);

/// What may limit a step: StepReport::limit is an index.
inline constexpr std::array<const char*, 11> kStepLimits{"sound",        "viscosity",  "acceleration", "light body",
                                                         "rigid engine", "end of run", "retry",        "flow speed",
                                                         "gravity",      "asleep",     "pressure"};

/// Step report to the coordinator, by each process, every step.
struct StepReport {
  std::uint64_t step;
  std::uint32_t iteration;
  std::uint32_t limit;             ///< what limits the step: index into kStepLimits
  double time, dt;                 ///< s, at the end of the step
  double wall_compute, wall_wait;  ///< s, spent computing / waiting in this step
  std::uint64_t hash;              ///< of the bodies' state as this process knows it at the end of the step
  double error[4];                 ///< density mean, density max, pressure residual, interface residual (relative)
  std::uint64_t particles;
  // Balances since the start of the run, resumed or not.
  double mass_drift;     ///< the fluid's mass over that at the start, less 1; 0 from a rigid process
  double energy_gain;    ///< the most that the fluid has gained, over the energy at play; NaN: no balance of energy
  double impulse[3];     ///< N s, world: of the fluid on all bodies that move; as given by the fluid, as received there
  double impulse_scale;  ///< N s, magnitudes of its parts (a body, a step) added up
};
static_assert(sizeof(StepReport) == 16 + 8 * 16);

/// For monitors: the fluid as a whole, fluid -> coordinator.
struct FluidStatistics {
  double mass;                                    ///< kg
  double kinetic, potential, elastic;             ///< J
  double momentum[3];                             ///< kg m/s
  double error_mean, error_max;                   ///< relative density error
  double max_speed, sound_speed;                  ///< m/s
  double sort, pressure, boundary, motion, wait;  ///< s of wall time since the start, by stage
  std::uint64_t particles, lost;
  std::uint64_t dropped;  ///< frames for monitors that found no room in the ring so far
  char limit[32];         ///< what StepReport::limit of the last step means, zero-terminated
};
static_assert(sizeof(FluidStatistics) == 8 * 19 + 32);

/// For monitors: heads a frame of particles.
struct ParticleSetHead {
  std::uint64_t particles;  ///< in the fluid
  std::uint32_t every;      ///< those follow whose id is a multiple of this
  std::uint32_t count;      ///< how many follow
};
static_assert(sizeof(ParticleSetHead) == 16);

/// For monitors: one particle.
struct ParticleSample {
  std::uint32_t id;   ///< the same through a run
  float position[3];  ///< m, world
  float velocity[3];  ///< m/s
  float pressure;     ///< Pa
};
static_assert(sizeof(ParticleSample) == 32);

/// A process has written its part of the checkpoint after a step (common/checkpoint): how the file can be told.
struct CheckpointPart {
  std::uint64_t bytes;
  std::uint64_t hash;  ///< that the file ends with
};
static_assert(sizeof(CheckpointPart) == 16);

/// Frames in a report ring. kFluid to kParticles are for monitors: written only if Header::monitor asks for them, and
/// dropped where there is no room.
enum class FrameKind : std::uint32_t {
  kStep = 0,
  kBodies = 1,
  kProbes = 2,
  kWarning = 3,
  kFluid = 4,
  kContacts = 5,
  kParticles = 6,
  kCheckpoint = 7,
  kCommand = 8
};
inline constexpr std::uint32_t kFrameKinds = 9;
/// Bit of Header::monitor that asks for frames of a kind.
constexpr std::uint32_t monitor_bit(FrameKind kind) { return 1u << static_cast<std::uint32_t>(kind); }
struct FrameHead {
  FrameKind kind;
  std::uint32_t bytes;  ///< of payload that follows
  std::uint64_t step;
  double time;  ///< s
};
static_assert(sizeof(FrameHead) == 24);

}  // namespace ballast::exchange
