// ODE as a solver of velocities: bodies that touch or are joined are grouped into islands and each island gets the
// stepper and the integration rule that suit it. Positions are integrated here, not by ODE.
#pragma once
#include <ode/ode.h>

#include <span>
#include <vector>

#include "rigid_client/body_set.h"
#include "rigid_client/ode_joints.h"
#include "rigid_client/ode_shapes.h"

namespace ballast::rigid {

class OdeSolver {
 public:
  OdeSolver();
  ~OdeSolver();
  OdeSolver(const OdeSolver&) = delete;
  OdeSolver& operator=(const OdeSolver&) = delete;

  Status load(const exchange::ManifestView& manifest, BodySet& bodies);
  void begin_step() { draw_ = 0; }
  /// Makes velocities fit the joints and lets contacts that approach faster than `threshold` (m/s) bounce; no time
  /// passes.
  void collide(BodySet& bodies, std::span<const ContactPoint> contacts, double threshold);
  /// Moves all dynamic bodies from `time` by h seconds.
  void advance(BodySet& bodies, std::span<const ContactPoint> contacts, double time, double h, double threshold);

 private:
  enum class Kind { kFree, kSmooth, kDirect, kIterative };
  struct Island {
    std::vector<std::size_t> bodies, contacts, joints;
    bool prescribed = false;
  };
  /// One call of a stepper on some islands.
  struct Batch {
    std::vector<const Island*> islands;
    Solve solve = Solve::kPlain;
    bool iterative = false;
    double h = 0;
    double threshold = 0;  // kImpulse: contacts faster than this bounce
    bool contacts = true;
  };

  void build_islands(const BodySet& bodies, std::span<const ContactPoint> contacts, double threshold);
  Kind kind(const Island& island, double h) const;
  void put_all(const BodySet& bodies);
  void put(const BodySet& bodies, std::size_t b);
  void take(BodySet& bodies, const Batch& batch) const;
  void run(BodySet& bodies, std::span<const ContactPoint> contacts, const Batch& batch);
  void fill(const BodySet& bodies, std::span<const ContactPoint> contacts, const Batch& batch);
  void add_contact(const BodySet& bodies, const ContactPoint& contact, const Batch& batch);
  void step_smooth(BodySet& bodies, const std::vector<const Island*>& islands, double h);
  void kick(BodySet& bodies, const std::vector<const Island*>& islands, double h);
  void step_plain(BodySet& bodies, std::span<const ContactPoint> contacts, const std::vector<const Island*>& islands,
                  double h, bool iterative);
  /// Makes velocities fit the joints at the poses reached: the midpoint rule alone keeps a misfit swinging, and
  /// together with the closing of gaps makes it grow (root -a - sqrt(1 + a^2) for a share a closed per step).
  void fit_joints(BodySet& bodies, const std::vector<const Island*>& islands, double h);
  void place_prescribed(const BodySet& bodies, double time, double h);

  dWorldID world_ = nullptr;
  dJointGroupID group_ = nullptr;
  std::vector<dBodyID> ode_;
  OdeJoints joints_;
  std::vector<Island> islands_;
  std::vector<Motion> prescribed_;    ///< mean twists over the step at hand
  std::vector<Vec3> force_, torque_;  ///< applied in the next run
  double heaviest_ = 1;               ///< kg
  double touch_depth_ = 0, push_speed_ = 0, threshold_ = 0;
  std::uint64_t draw_ = 0;  ///< runs since the step began: part of the random seed
};

}  // namespace ballast::rigid
