// ODE joints: the manifest's joints with limits, motors, springs and dampers, prepared for the kind of solve at hand.
#pragma once
#include <ode/ode.h>

#include <vector>

#include "rigid_client/body_set.h"

namespace ballast::rigid {

/// What a call of an ODE stepper is for.
enum class Solve {
  kPlain,    ///< a step: velocities at its end
  kSmooth,   ///< half a step towards the mean velocity of a midpoint step: neither limits nor motors act
  kImpulse,  ///< no time passes: velocities are made to fit joints and contacts; motors and springs are silent
  kKick      ///< the same with all that springs do in a step: before the drift of bodies that the fluid pushes
};

class OdeJoints {
 public:
  /// Makes the joints at the bodies' poses at t = 0. `ode` has one entry per body, null where it has no ODE body.
  Status load(const exchange::ManifestView& manifest, BodySet& bodies, dWorldID world, const std::vector<dBodyID>& ode);

  std::size_t size() const { return entries_.size(); }
  /// The ends of joint j as body indices; -1: world or static.
  int parent(std::size_t j) const { return entries_[j].parent; }
  int child(std::size_t j) const { return entries_[j].record.child; }

  /// Reads angles and lengths at the poses and velocities that the ODE bodies have now; counts turns in bodies.extra.
  void measure(BodySet& bodies);
  /// True if neither a motor nor a limit acts within the next h seconds.
  bool smooth(std::size_t j, double h) const;
  /// Whether the spring of joint j acts in the kick, and is silent in the drift.
  void kick_spring(std::size_t j, bool kicks) { entries_[j].kicks = kicks; }
  /// Sets the parameters of all joints for a solve over h seconds. `softness`: constraint force mixing that keeps
  /// closed loops regular.
  void prepare(Solve solve, double h, double softness);

 private:
  struct Entry {
    exchange::JointRecord record{};
    int parent = -1;
    dJointID joint = nullptr;
    dJointID spring = nullptr;   // motor whose target and softness make an implicit spring and damper
    double value = 0, rate = 0;  // rad, rad/s or m, m/s
    bool kicks = false;
  };
  Status check(const exchange::JointRecord& record, const BodySet& bodies) const;
  void make(Entry& entry, dWorldID world, dBodyID child, dBodyID parent);
  void make_spring(Entry& entry, dWorldID world, dBodyID child, dBodyID parent);
  static void set(const Entry& entry, int parameter, double value);
  static void prepare_spring(const Entry& entry, Solve solve, double h);

  std::vector<Entry> entries_;
  dWorldID world_ = nullptr;
  double return_speed_ = 0;  // rad/s or m/s: fastest return from beyond a limit
};

}  // namespace ballast::rigid
