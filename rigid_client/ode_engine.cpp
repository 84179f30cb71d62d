// The default engine: Open Dynamics Engine behind the contract of engine.h. This file is the step; islands and
// integration are in ode_solver, geometry in ode_shapes, joints in ode_joints.
#include <fmt/format.h>
#include <ode/ode.h>

#include <algorithm>
#include <cmath>

#include "rigid_client/body_set.h"
#include "rigid_client/engine.h"
#include "rigid_client/engine_factories.h"
#include "rigid_client/ode_shapes.h"
#include "rigid_client/ode_solver.h"

namespace ballast::rigid {

namespace {

constexpr int kMostCuts = 2;          // times that a step may be cut at impacts
constexpr double kLeastPiece = 0.01;  // of the step
constexpr double kTravel = 0.5;       // of a body's least half extent: farthest move in one piece, against tunnelling
constexpr double kStartLean = 1e-9;   // share of its height by which a body leans onto what is below, at the start
constexpr double kTouchDepth = 1e-4;  // of length_scale: impacts deeper than this cut the step

class OdeEngine : public Engine {
 public:
  Status load(const ManifestView& manifest) override {
    if (auto fine = bodies_.load(manifest); !fine) return fine;
    if (auto fine = shapes_.load(manifest); !fine) return fine;
    solver_ = std::make_unique<OdeSolver>();
    if (auto fine = solver_->load(manifest, bodies_); !fine) return fine;
    held_.assign(bodies_.size(), false);
    jointed_.clear();
    for (const auto& joint : manifest.joints) {
      for (const std::int32_t b : {joint.parent, joint.child})
        if (b >= 0) jointed_.push_back(static_cast<std::size_t>(b));
      const bool to_world = joint.parent < 0 || !bodies_.dynamic(static_cast<std::size_t>(joint.parent));
      if (joint.type == exchange::JointType::kFixed && to_world) held_[static_cast<std::size_t>(joint.child)] = true;
    }
    return ok();
  }

  void apply(std::span<const exchange::Wrench> wrenches) override { bodies_.set_wrenches(wrenches); }

  Status step(double time, double dt) override {
    bodies_.begin_step();
    for (const std::size_t b : jointed_) bodies_.constrain(b);
    solver_->begin_step();
    const double g = bodies_.gravity().norm();
    threshold_ = 2 * g * dt + 1e-6 * bodies_.world.length_scale / dt;
    double done = 0;
    int cuts = 0;
    at_rest() ? collide_leaning() : shapes_.collide(bodies_, contacts_);
    while (done < dt * (1 - 1e-12)) {
      note_contacts();
      if (approaching()) strike();
      const double piece = std::min(dt - done, std::max(longest_piece(), kLeastPiece * dt));
      done += advance(time + done, piece, cuts < kMostCuts ? kLeastPiece * dt : piece, cuts);
    }
    bodies_.drive(time + dt);
    return bodies_.end_step(dt);
  }

  void read(std::span<exchange::BodyState> states) const override { bodies_.read(states); }
  void mobility(std::span<exchange::BodyState> states) const override { bodies_.mobility(states, held_); }
  void save(std::vector<std::byte>& out) const override { bodies_.save(out); }
  Status restore(std::span<const std::byte> in) override { return bodies_.restore(in); }
  Status obey(const exchange::Command& command) override { return bodies_.obey(command); }

  std::string describe() const override {
    return fmt::format("ode {}, double precision, direct stepper for small islands, QuickStep for large ones",
                       dODE_VERSION);
  }

 private:
  double approach(const ContactPoint& c) const {
    return -(velocity_at(bodies_.now[c.body], c.position) - velocity_at(bodies_.now[c.other], c.position))
                .dot(c.normal);
  }

  bool at_rest() const {
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const Motion& m = bodies_.now[b];
      if (bodies_.dynamic(b) && !(m.velocity.isZero(0) && m.spin.isZero(0))) return false;
    }
    return true;
  }

  /// Contacts before anything moves. Whether bodies that a scene puts exactly onto each other touch is left to
  /// rounding; those that do not would fall for a step, which the fluid takes for a release.
  void collide_leaning() {
    const std::vector<Motion> placed = bodies_.now;
    const Vec3 down = bodies_.gravity().stableNormalized();
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (!bodies_.dynamic(b)) continue;
      Vec3& position = bodies_.now[b].position;
      position += kStartLean * (bodies_.world.length_scale - down.dot(position)) * down;
    }
    shapes_.collide(bodies_, contacts_);
    bodies_.now = placed;
  }

  void note_contacts() {
    for (const ContactPoint& c : contacts_) bodies_.constrain(c.body), bodies_.constrain(c.other);
  }

  /// Impacts, in zero time.
  void strike() {
    const std::vector<Motion> before = bodies_.now;
    solver_->collide(bodies_, contacts_, threshold_);
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      bodies_.strike(b, bodies_.now[b].velocity - before[b].velocity, bodies_.now[b].spin - before[b].spin);
  }

  bool approaching() const {
    return std::any_of(contacts_.begin(), contacts_.end(),
                       [&](const ContactPoint& c) { return approach(c) > threshold_; });
  }

  double longest_piece() const {
    double piece = HUGE_VAL;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      const double speed = bodies_.now[b].velocity.norm(), half = shapes_.half_extent(b);
      if (bodies_.dynamic(b) && half > 0 && speed > 0) piece = std::min(piece, kTravel * half / speed);
    }
    return piece;
  }

  /// Time since the earliest impact of the piece just done, s; 0 if nothing hit deeper than the touch depth.
  double since_impact() const {
    const double touch = kTouchDepth * bodies_.world.length_scale;
    double since = 0;
    for (const ContactPoint& c : contacts_) {
      const double speed = approach(c);
      if (c.depth > touch && speed > threshold_) since = std::max(since, (c.depth - 0.5 * touch) / speed);
    }
    return since;
  }

  /// Moves by `piece` or, where a body hits something in between, to that moment; returns the time moved. Bouncing at
  /// the right place keeps low rebounds right and lets nothing gain energy from being deep in the floor.
  double advance(double time, double piece, double least, int& cuts) {
    const std::vector<Motion> start = bodies_.now;
    const std::vector<double> start_extra = bodies_.extra;
    const std::vector<ContactPoint> before = contacts_;
    solver_->advance(bodies_, before, time, piece, threshold_);
    bodies_.drive(time + piece);
    shapes_.collide(bodies_, contacts_);
    const double since = since_impact();
    if (since <= 0 || least >= piece) return piece;
    ++cuts;
    const double shorter = std::max(piece - since, least);
    if (shorter >= piece) return piece;
    bodies_.now = start;
    bodies_.extra = start_extra;
    solver_->advance(bodies_, before, time, shorter, threshold_);
    bodies_.drive(time + shorter);
    shapes_.collide(bodies_, contacts_);
    return shorter;
  }

  BodySet bodies_;
  OdeShapes shapes_;
  std::unique_ptr<OdeSolver> solver_;
  std::vector<ContactPoint> contacts_;
  std::vector<bool> held_;
  std::vector<std::size_t> jointed_;
  double threshold_ = 0;  // m/s: contacts that approach faster are impacts
};

}  // namespace

std::unique_ptr<Engine> make_ode_engine() { return std::make_unique<OdeEngine>(); }

}  // namespace ballast::rigid
