// Commands from outside at the borders of steps: wrenches that act on bodies for a while beside the fluid's, poses and
// gravity, which the engine keeps.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/exchange/manifest.h"
#include "rigid_client/engine.h"
#include "rigid_client/ode_overlap.h"

namespace ballast::rigid {

class Outside {
 public:
  explicit Outside(const exchange::ManifestView& manifest) : manifest_(manifest) {}

  /// Takes a command at `time`, the end of a step with the bodies at `states`. The reason why not, or nothing; `states`
  /// are out of date if the engine took it.
  std::string take(const exchange::Command& command, double time, std::span<const exchange::BodyState> states,
                   Engine& engine);

  /// Adds what acts on a step that begins at `time`, and forgets what has ended.
  void add_to(std::span<exchange::Wrench> wrenches, double time);
  /// Adds what will act on the step that begins at `time` to the motion that the bodies have without the fluid.
  void add_to(std::span<exchange::BodyState> states, double time) const;
  bool pushes() const { return !pushes_.empty(); }

  /// What acts, for going back a step and for checkpoints.
  struct Push {
    std::uint64_t body;
    double wrench[6];    ///< N, N m
    double from, until;  ///< s
  };
  const std::vector<Push>& save() const { return pushes_; }
  void restore(const std::vector<Push>& pushes) { pushes_ = pushes; }

 private:
  std::string place(const exchange::Command& command, std::span<const exchange::BodyState> states, Engine& engine);

  const exchange::ManifestView& manifest_;
  std::vector<Push> pushes_;
  std::unique_ptr<Overlap> overlap_;  // made when first needed
};

}  // namespace ballast::rigid
