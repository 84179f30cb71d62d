// What a rigid-body engine must do: a few functions on spans of plain records. Swap engines by writing these.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/exchange/manifest.h"
#include "common/result.h"

namespace ballast {

using exchange::ManifestView;

class Engine {
 public:
  virtual ~Engine() = default;
  /// Builds bodies, shapes and joints. A capability that the engine lacks is an error that names it (exit code 2).
  virtual Status load(const ManifestView& manifest) = 0;
  /// Wrenches about the centres of mass, world frame, one per body of the manifest, held constant over the next step().
  virtual void apply(std::span<const exchange::Wrench> wrenches) = 0;
  /// Advances by dt seconds from `time`. Deterministic: same state and wrenches give the same bits.
  virtual Status step(double time, double dt) = 0;
  /// Position, orientation, velocities of every body, in the manifest's order; acceleration over the last step.
  virtual void read(std::span<exchange::BodyState> states) const = 0;
  /// Free acceleration and mobility of every body at its present pose (free-body values are always safe).
  virtual void mobility(std::span<exchange::BodyState> states) const = 0;
  /// Everything that the next step depends on, warm start and random state included, as bytes.
  virtual void save(std::vector<std::byte>& out) const = 0;
  virtual Status restore(std::span<const std::byte> in) = 0;
  /// A pose of a body that moves freely, or a gravity, from outside; between two steps. From here on in save() too.
  /// Wrenches from outside come with apply(). What an engine cannot do it refuses by name.
  virtual Status obey(const exchange::Command& command) = 0;
  /// What the engine leaves out although a scene may count on it, as a warning for the record; empty: nothing.
  virtual std::string lacks() const { return ""; }
  /// One line for the run record: engine, version, precision, stepper.
  virtual std::string describe() const = 0;
};

/// Names of the engines built in, first is the default.
std::vector<std::string> engine_names();
/// Makes an engine by name; an unknown name is an error that lists engine_names().
Result<std::unique_ptr<Engine>> make_engine(const std::string& name);

}  // namespace ballast
