// Bodies that touch nothing: Newton and Euler, no contacts, no joints. Reference and test double for larger engines.
#include <fmt/format.h>

#include "rigid_client/body_set.h"
#include "rigid_client/engine.h"
#include "rigid_client/engine_factories.h"

namespace ballast::rigid {

namespace {

class FreeBodyEngine : public Engine {
 public:
  Status load(const ManifestView& manifest) override {
    if (!manifest.joints.empty()) {
      return Error{
          fmt::format("engine free_body has no joints, but joint '{}' is in the scene", manifest.joints[0].name),
          "use coupling.engine: ode", "", kBadInput};
    }
    return bodies_.load(manifest);
  }

  void apply(std::span<const exchange::Wrench> wrenches) override { bodies_.set_wrenches(wrenches); }

  Status step(double time, double dt) override {
    bodies_.begin_step();
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (bodies_.dynamic(b)) bodies_.fly(b, dt);
    }
    bodies_.drive(time + dt);
    return bodies_.end_step(dt);
  }

  void read(std::span<exchange::BodyState> states) const override { bodies_.read(states); }
  void mobility(std::span<exchange::BodyState> states) const override {
    bodies_.mobility(states, std::vector<bool>(bodies_.size(), false));
  }
  void save(std::vector<std::byte>& out) const override { bodies_.save(out); }
  Status restore(std::span<const std::byte> in) override { return bodies_.restore(in); }
  Status obey(const exchange::Command& command) override { return bodies_.obey(command); }
  std::string lacks() const override {
    return "engine free_body knows no contacts: bodies pass through each other and through walls; use coupling.engine: "
           "ode "
           "where they touch";
  }
  std::string describe() const override {
    return "free_body, double precision, free flight only: no contacts, no joints";
  }

 private:
  BodySet bodies_;
};

}  // namespace

std::unique_ptr<Engine> make_free_body_engine() { return std::make_unique<FreeBodyEngine>(); }

}  // namespace ballast::rigid
