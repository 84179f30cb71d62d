// Islands, and one call of an ODE stepper on some of them: what goes in (poses, forces, contacts), what comes out
// (velocities).
#include "rigid_client/ode_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <numeric>

namespace ballast::rigid {

namespace {

constexpr std::size_t kDirectContacts = 48;  // per island: exact for stacks of ten boxes; the cost grows with the cube
constexpr std::size_t kDirectJoints = 100;   // per island
constexpr int kIterations = 50;              // of the iterative stepper
constexpr double kTouchDepth = 1e-4;         // of length_scale: resting contacts may be this deep
constexpr double kPushShare = 0.05;     // of sqrt(g L): fastest push out of a deep contact, so that none throws a body
constexpr double kContactErp = 0.2;     // share of the depth beyond the touch depth removed per step
constexpr double kSoftness = 1e-9;      // of the inverse mass: keeps four feet on a floor regular, creep 1e-9 g h
constexpr double kSlipping = 0.01;      // of the bounce threshold: slower contacts stick, their direction is noise
constexpr double kPlanarInertia = 1e6;  // of I_yy: turns out of the plane are this much harder

bool g_direct_failed = false;  // set by ODE's message handler; the process is single-threaded

// ODE reports a failed direct solve only as a message.
void on_message(int, const char*, va_list) { g_direct_failed = true; }

// splitmix64 (Steele, Lea, Flood 2014): seeds of neighbouring steps must not resemble each other.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

double approach_speed(const BodySet& bodies, const Motion& other, const ContactPoint& c) {
  return -(velocity_at(bodies.now[c.body], c.position) - velocity_at(other, c.position)).dot(c.normal);
}

std::size_t root(std::vector<std::size_t>& parent, std::size_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

void join(std::vector<std::size_t>& parent, std::size_t a, std::size_t b) {
  const std::size_t ra = root(parent, a), rb = root(parent, b);
  parent[std::max(ra, rb)] = std::min(ra, rb);
}

Vec3 any_tangent(const Vec3& n) {
  const Vec3 axis = std::abs(n.x()) < 0.6 ? Vec3::UnitX() : Vec3::UnitY();
  return n.cross(axis).normalized();
}

}  // namespace

OdeSolver::OdeSolver() {
  dSetMessageHandler(on_message);
  world_ = dWorldCreate();
  dWorldSetGravity(world_, 0, 0, 0);
  dWorldSetAutoDisableFlag(world_, 0);
  dWorldSetQuickStepNumIterations(world_, kIterations);
  group_ = dJointGroupCreate(0);
}

OdeSolver::~OdeSolver() {
  dJointGroupDestroy(group_);
  dWorldDestroy(world_);
}

Status OdeSolver::load(const exchange::ManifestView& manifest, BodySet& bodies) {
  const std::size_t n = bodies.size();
  ode_.assign(n, nullptr);
  prescribed_ = bodies.now;
  force_.assign(n, Vec3::Zero());
  torque_.assign(n, Vec3::Zero());
  std::vector<bool> jointed(n, false);
  for (const auto& joint : manifest.joints) {
    for (const int end : {joint.parent, joint.child}) {
      if (end >= 0 && static_cast<std::size_t>(end) < n) jointed[static_cast<std::size_t>(end)] = true;
    }
  }
  heaviest_ = 0;
  for (std::size_t b = 0; b < n; ++b) {
    if (!bodies.dynamic(b) && !(bodies.prescribed(b) && jointed[b])) continue;
    ode_[b] = dBodyCreate(world_);
    dBodySetGyroscopicMode(ode_[b], 0);  // done exactly by BodySet::gyroscopic_spin
    if (bodies.prescribed(b)) {
      dBodySetKinematic(ode_[b]);
      continue;
    }
    const Mat3& i = bodies.inertia[b].body;
    const double iyy = i(1, 1), out = kPlanarInertia * iyy;
    dMass mass;
    dMassSetZero(&mass);
    if (bodies.planar()) {
      dMassSetParameters(&mass, bodies.inertia[b].mass, 0, 0, 0, out, iyy, out, 0, 0, 0);
    } else {
      dMassSetParameters(&mass, bodies.inertia[b].mass, 0, 0, 0, i(0, 0), iyy, i(2, 2), i(0, 1), i(0, 2), i(1, 2));
    }
    dBodySetMass(ode_[b], &mass);
    heaviest_ = std::max(heaviest_, bodies.inertia[b].mass);
  }
  if (heaviest_ == 0) heaviest_ = 1;
  const double g = bodies.gravity().norm(), length = bodies.world.length_scale;
  touch_depth_ = kTouchDepth * length;
  push_speed_ = g > 0 ? kPushShare * std::sqrt(g * length) : length / bodies.world.duration;
  dWorldSetContactSurfaceLayer(world_, touch_depth_);
  put_all(bodies);
  if (auto fine = joints_.load(manifest, bodies, world_, ode_); !fine) return fine;
  collide(bodies, {}, 0);
  return ok();
}

void OdeSolver::put(const BodySet& bodies, std::size_t b) {
  const Motion& m = bodies.prescribed(b) ? prescribed_[b] : bodies.now[b];
  const dQuaternion q = {m.orientation.w(), m.orientation.x(), m.orientation.y(), m.orientation.z()};
  dBodySetPosition(ode_[b], m.position.x(), m.position.y(), m.position.z());
  dBodySetQuaternion(ode_[b], q);
  dBodySetLinearVel(ode_[b], m.velocity.x(), m.velocity.y(), m.velocity.z());
  dBodySetAngularVel(ode_[b], m.spin.x(), m.spin.y(), m.spin.z());
}

void OdeSolver::put_all(const BodySet& bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (ode_[b] != nullptr) put(bodies, b);
  }
}

void OdeSolver::build_islands(const BodySet& bodies, std::span<const ContactPoint> contacts, double threshold) {
  const std::size_t n = bodies.size();
  std::vector<std::size_t> parent(n);
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto is_node = [&](int b) { return b >= 0 && ode_[static_cast<std::size_t>(b)] != nullptr; };
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (is_node(joints_.parent(j)))
      join(parent, static_cast<std::size_t>(joints_.parent(j)), static_cast<std::size_t>(joints_.child(j)));
  }
  // A contact that separates faster than anything in a step can stop is over; its body flies.
  std::vector<bool> dropped(contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const ContactPoint& contact = contacts[c];
    const bool two = bodies.dynamic(contact.other);
    const Motion& other = two ? bodies.now[contact.other] : prescribed_[contact.other];
    dropped[c] = approach_speed(bodies, other, contact) < -threshold;
    if (!dropped[c] && two) join(parent, contact.body, contact.other);
  }
  islands_.clear();
  std::vector<std::size_t> index(n);
  for (std::size_t b = 0; b < n; ++b) {
    if (ode_[b] == nullptr) continue;
    const std::size_t r = root(parent, b);
    if (r == b) {
      index[b] = islands_.size();
      islands_.emplace_back();
    }
    islands_[index[r]].bodies.push_back(b);
  }
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (!dropped[c]) islands_[index[root(parent, contacts[c].body)]].contacts.push_back(c);
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    islands_[index[root(parent, static_cast<std::size_t>(joints_.child(j)))]].joints.push_back(j);
  }
}

OdeSolver::Kind OdeSolver::kind(const Island& island, double h) const {
  if (island.contacts.empty() && island.joints.empty()) return Kind::kFree;
  if (island.contacts.size() > kDirectContacts || island.joints.size() > kDirectJoints) return Kind::kIterative;
  const bool smooth =
      std::all_of(island.joints.begin(), island.joints.end(), [&](std::size_t j) { return joints_.smooth(j, h); });
  return smooth && island.contacts.empty() ? Kind::kSmooth : Kind::kDirect;
}

void OdeSolver::add_contact(const BodySet& bodies, const ContactPoint& c, const Batch& batch) {
  const bool two = bodies.dynamic(c.other);
  const Motion& other = two ? bodies.now[c.other] : prescribed_[c.other];
  const Vec3 surface = two ? Vec3(Vec3::Zero()) : velocity_at(other, c.position);
  const Vec3 relative = velocity_at(bodies.now[c.body], c.position) - velocity_at(other, c.position);
  const double approach = -relative.dot(c.normal);
  const bool impulse = batch.solve == Solve::kImpulse;
  // The friction pyramid's first edge lies along the slip, so that sliding is isotropic.
  const Vec3 slip = relative + approach * c.normal;
  Vec3 along = slip.norm() > kSlipping * batch.threshold ? Vec3(slip.normalized()) : any_tangent(c.normal);
  if (bodies.planar()) along = Vec3(c.normal.z(), 0, -c.normal.x());
  const Vec3 across = c.normal.cross(along);

  dContact contact{};
  dSurfaceParameters& s = contact.surface;
  s.mode = dContactMu2 | dContactFDir1 | dContactApprox1 | dContactSoftERP | dContactSoftCFM | dContactMotion1 |
           dContactMotion2 | dContactMotionN;
  s.mu = c.friction;
  s.mu2 = bodies.planar() ? 0 : c.friction;
  const double beyond = c.depth - touch_depth_;
  s.soft_erp = impulse || beyond <= 0 ? 0 : std::min(kContactErp, push_speed_ * batch.h / beyond);
  s.soft_cfm = kSoftness * batch.h * (bodies.inertia[c.body].inverse_mass + bodies.inertia[c.other].inverse_mass);
  s.motion1 = surface.dot(along);
  s.motion2 = surface.dot(across);
  s.motionN = surface.dot(c.normal);
  if (impulse && approach > batch.threshold) s.motionN += c.restitution * approach;
  for (int k = 0; k < 3; ++k) {
    contact.fdir1[k] = along[k];
    contact.geom.pos[k] = c.position[k];
    contact.geom.normal[k] = c.normal[k];
  }
  contact.geom.depth = c.depth;
  dJointAttach(dJointCreateContact(world_, group_, &contact), ode_[c.body], two ? ode_[c.other] : nullptr);
}

void OdeSolver::fill(const BodySet& bodies, std::span<const ContactPoint> contacts, const Batch& batch) {
  for (const dBodyID body : ode_) {
    if (body != nullptr) dBodyDisable(body);
  }
  for (const Island* island : batch.islands) {
    for (const std::size_t b : island->bodies) {
      dBodyEnable(ode_[b]);
      dBodySetForce(ode_[b], force_[b].x(), force_[b].y(), force_[b].z());
      dBodySetTorque(ode_[b], torque_[b].x(), torque_[b].y(), torque_[b].z());
    }
    if (!batch.contacts) continue;
    for (const std::size_t c : island->contacts) add_contact(bodies, contacts[c], batch);
  }
  joints_.prepare(batch.solve, batch.h, kSoftness * batch.h / heaviest_);
}

void OdeSolver::take(BodySet& bodies, const Batch& batch) const {
  for (const Island* island : batch.islands) {
    for (const std::size_t b : island->bodies) {
      if (!bodies.dynamic(b)) continue;
      const dReal *v = dBodyGetLinearVel(ode_[b]), *w = dBodyGetAngularVel(ode_[b]);
      bodies.now[b].velocity = Vec3(v[0], v[1], v[2]);
      bodies.now[b].spin = Vec3(w[0], w[1], w[2]);
      bodies.confine(b);
    }
  }
}

// Poses and velocities have been put into ODE; brings back velocities only.
void OdeSolver::run(BodySet& bodies, std::span<const ContactPoint> contacts, const Batch& batch) {
  if (batch.islands.empty()) return;
  fill(bodies, contacts, batch);
  g_direct_failed = false;
  dRandSetSeed(static_cast<unsigned long>(mixed(mixed(bodies.world.seed ^ bodies.steps) + draw_++)));
  if (batch.iterative) {
    dWorldQuickStep(world_, batch.h);
  } else {
    dWorldStep(world_, batch.h);
  }
  dJointGroupEmpty(group_);
  if (g_direct_failed && !batch.iterative) {
    put_all(bodies);
    Batch again = batch;
    again.iterative = true;
    run(bodies, contacts, again);
    return;
  }
  take(bodies, batch);
}

void OdeSolver::collide(BodySet& bodies, std::span<const ContactPoint> contacts, double threshold) {
  prescribed_ = bodies.now;
  build_islands(bodies, contacts, threshold);
  std::fill(force_.begin(), force_.end(), Vec3::Zero());
  std::fill(torque_.begin(), torque_.end(), Vec3::Zero());
  Batch direct, iterative;
  for (const Island& island : islands_) {
    const bool hit = std::any_of(island.contacts.begin(), island.contacts.end(), [&](std::size_t c) {
      return approach_speed(bodies, bodies.now[contacts[c].other], contacts[c]) > threshold;
    });
    const bool first = contacts.empty() && !island.joints.empty();  // at load: make velocities fit the joints
    if (!hit && !first) continue;
    const bool few = island.contacts.size() <= kDirectContacts && island.joints.size() <= kDirectJoints;
    (few ? direct : iterative).islands.push_back(&island);
  }
  put_all(bodies);
  joints_.measure(bodies);
  for (Batch* batch : {&direct, &iterative}) {
    batch->solve = Solve::kImpulse;
    batch->iterative = batch == &iterative;
    batch->h = 1;
    batch->threshold = threshold;
    run(bodies, contacts, *batch);
  }
}

}  // namespace ballast::rigid
