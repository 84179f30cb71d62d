// The integration of islands on top of ODE's steppers.
//
// Four kinds of island, cheapest first (figures in README.md):
//   free       one body, no contact, no joint: exact flight, ODE is not asked (BodySet::fly)
//   smooth     joints only, no motor or limit at work: midpoint rule. ODE solves the mean velocity v' of the step,
//              J v' = 0 at the predicted middle, as half a backward step; then v_1 = 2 v' - v_0, x_1 = x_0 + h v'.
//              Joints then do no work, so that a pendulum neither gains nor loses energy
//   direct     few contacts, motors, limits: ODE's dWorldStep (Dantzig)
//   iterative  many contacts: ODE's dWorldQuickStep, whose direct rival grows with the cube of the contacts
#include <algorithm>

#include "rigid_client/ode_solver.h"

namespace ballast::rigid {

void OdeSolver::place_prescribed(const BodySet& bodies, double time, double h) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies.dynamic(b)) continue;
    prescribed_[b] = bodies.now[b];
    if (!bodies.prescribed(b)) continue;
    // Mean twist over the step: contacts then follow the motion exactly, however it starts and stops.
    const Motion end = prescribed_motion(bodies.records[b], time + h);
    const Eigen::AngleAxisd turn(end.orientation * bodies.now[b].orientation.conjugate());
    prescribed_[b].velocity = (end.position - bodies.now[b].position) / h;
    prescribed_[b].spin = turn.axis() * (turn.angle() / h);
  }
}

void OdeSolver::advance(BodySet& bodies, std::span<const ContactPoint> contacts, double time, double h,
                        double threshold) {
  place_prescribed(bodies, time, h);
  threshold_ = threshold;
  build_islands(bodies, contacts, threshold);
  put_all(bodies);
  joints_.measure(bodies);
  std::vector<const Island*> smooth, direct, iterative;
  for (const Island& island : islands_) {
    switch (kind(island, h)) {
      case Kind::kFree:
        if (bodies.dynamic(island.bodies[0])) bodies.fly(island.bodies[0], h);
        break;
      case Kind::kSmooth:
        smooth.push_back(&island);
        break;
      case Kind::kDirect:
        direct.push_back(&island);
        break;
      case Kind::kIterative:
        iterative.push_back(&island);
        break;
    }
  }
  step_smooth(bodies, smooth, h);
  step_plain(bodies, contacts, direct, h, false);
  step_plain(bodies, contacts, iterative, h, true);
}

// The fluid's wrench depends on the position, and the midpoint step alone would pump it (growth w^2 h/4 per second,
// COUPLING.md 4): it is given as a kick before, together with the weight and the springs that it may balance. Left to
// the midpoint, they would move the body by another velocity than the one that the fluid is told.
void OdeSolver::kick(BodySet& bodies, const std::vector<const Island*>& islands, double h) {
  Batch batch;
  for (const Island* island : islands) {
    const bool wet = std::any_of(island->bodies.begin(), island->bodies.end(),
                                 [&](std::size_t b) { return bodies.dynamic(b) && bodies.has_wrench(b); });
    for (const std::size_t b : island->bodies) {
      const Vec3 weight = bodies.inertia[b].mass * bodies.gravity();
      force_[b] = wet ? Vec3(weight + bodies.force(b)) : weight;
      torque_[b] = bodies.torque(b);
    }
    for (const std::size_t j : island->joints) joints_.kick_spring(j, wet);
    if (wet) batch.islands.push_back(island);
  }
  batch.solve = Solve::kKick;
  batch.h = h;
  run(bodies, {}, batch);
  for (const Island* island : batch.islands) {
    for (const std::size_t b : island->bodies) force_[b] = torque_[b] = Vec3::Zero();
  }
}

void OdeSolver::step_smooth(BodySet& bodies, const std::vector<const Island*>& islands, double h) {
  if (islands.empty()) return;
  kick(bodies, islands, h);
  std::vector<Motion> start = bodies.now;
  const std::vector<Motion> drives = prescribed_;
  for (const Island* island : islands) {
    for (const std::size_t b : island->bodies) {
      Motion& m = bodies.prescribed(b) ? prescribed_[b] : bodies.now[b];
      const Vec3 turned = bodies.dynamic(b) ? bodies.gyroscopic_spin(b, 0.5 * h) : m.spin;
      m.position += 0.5 * h * m.velocity;
      m.orientation = rotated(m.orientation, 0.5 * h * m.spin);
      if (bodies.dynamic(b)) torque_[b] = bodies.inertia[b].world(m.orientation) * (turned - m.spin) / (0.5 * h);
      put(bodies, b);
    }
  }
  Batch batch;
  batch.islands = islands;
  batch.solve = Solve::kSmooth;
  batch.h = 0.5 * h;
  run(bodies, {}, batch);
  for (const Island* island : islands) {
    for (const std::size_t b : island->bodies) {
      if (!bodies.dynamic(b)) continue;
      Motion &m = bodies.now[b], &s = start[b];
      m.position = s.position + h * m.velocity;
      m.orientation = rotated(s.orientation, h * m.spin);
      m.velocity = 2 * m.velocity - s.velocity;
      m.spin = 2 * m.spin - s.spin;
      bodies.confine(b);
    }
  }
  prescribed_ = drives;
  fit_joints(bodies, islands, h);
}

void OdeSolver::step_plain(BodySet& bodies, std::span<const ContactPoint> contacts,
                           const std::vector<const Island*>& islands, double h, bool iterative) {
  if (islands.empty()) return;
  Batch batch;
  batch.islands = islands;
  batch.iterative = iterative;
  batch.h = h;
  batch.threshold = threshold_;
  for (const Island* island : islands) {
    for (const std::size_t b : island->bodies) {
      if (!bodies.dynamic(b)) continue;
      force_[b] = bodies.inertia[b].mass * bodies.gravity() + bodies.force(b);
      const Mat3 inertia = bodies.inertia[b].world(bodies.now[b].orientation);
      torque_[b] = bodies.torque(b) + inertia * (bodies.gyroscopic_spin(b, h) - bodies.now[b].spin) / h;
    }
  }
  run(bodies, contacts, batch);
  for (const Island* island : islands) {
    for (const std::size_t b : island->bodies) {
      if (!bodies.dynamic(b)) continue;
      Motion& m = bodies.now[b];
      m.position += h * m.velocity;
      m.orientation = rotated(m.orientation, h * m.spin);
      bodies.confine(b);
    }
  }
  if (!iterative) fit_joints(bodies, islands, h);
}

void OdeSolver::fit_joints(BodySet& bodies, const std::vector<const Island*>& islands, double h) {
  const std::vector<Motion> drives = prescribed_;
  Batch batch;
  batch.solve = Solve::kImpulse;
  batch.h = 1;
  batch.contacts = false;
  for (const Island* island : islands) {
    if (island->joints.empty()) continue;
    batch.islands.push_back(island);
    for (const std::size_t b : island->bodies) {
      Motion& m = prescribed_[b];
      m.position += h * m.velocity;
      m.orientation = rotated(m.orientation, h * m.spin);
      force_[b] = torque_[b] = Vec3::Zero();
      put(bodies, b);
    }
  }
  run(bodies, {}, batch);
  prescribed_ = drives;
}

}  // namespace ballast::rigid
