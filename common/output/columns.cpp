// Names of the columns of bodies.csv and probes.csv.
#include "common/output/columns.h"

namespace ballast::output {
namespace {

void append(std::vector<std::string>& out, const std::string& name, std::initializer_list<const char*> parts) {
  for (const char* part : parts) out.push_back(name + "." + part);
}

}  // namespace

std::vector<int> moving_models(const Scene& scene) {
  std::vector<int> out;
  for (std::size_t i = 0; i < scene.models.size(); ++i) {
    if (scene.models[i].motion != Motion::kStatic) out.push_back(static_cast<int>(i));
  }
  return out;
}

std::vector<std::string> body_columns(const Scene& scene) {
  std::vector<std::string> out;
  for (int i : moving_models(scene)) {
    append(out, scene.models[static_cast<std::size_t>(i)].name,
           {"x",  "y",  "z",  "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx",
            "wy", "wz", "ax", "ay", "az", "fx", "fy", "fz", "tx", "ty", "tz"});
  }
  return out;
}

std::vector<std::string> probe_columns(const Scene& scene) {
  std::vector<std::string> out;
  for (const Probe& probe : scene.probes) {
    switch (probe.kind) {
      case ProbeKind::kLevel:
      case ProbeKind::kPressure:
      case ProbeKind::kPressureError:
      case ProbeKind::kVoid:
        out.push_back(probe.name);
        break;
      case ProbeKind::kVelocity:
        append(out, probe.name, {"vx", "vy", "vz"});
        break;
      case ProbeKind::kForce:
        append(out, probe.name, {"fx", "fy", "fz", "tx", "ty", "tz"});
        break;
      case ProbeKind::kMotion:
        append(out, probe.name, {"px", "py", "pz", "lx", "ly", "lz", "fastest"});
        break;
      case ProbeKind::kPose:
        append(out, probe.name, {"x", "y", "z", "qw", "qx", "qy", "qz"});
        break;
    }
  }
  return out;
}

}  // namespace ballast::output
