// Checks of probes and expectations: what they name exists, and what they ask can be answered.
#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>

#include "common/scene/check.h"
#include "common/scene/fields.h"
#include "common/scene/nearest.h"

namespace ballast::scene {
namespace {

/// The part of a column's name behind the last dot, and what its values are.
struct Part {
  std::string_view name;
  Quantity quantity;
};

constexpr Part kParts[] = {
    {"x", kLength},        {"y", kLength},        {"z", kLength},        {"qw", kNone},         {"qx", kNone},
    {"qy", kNone},         {"qz", kNone},         {"vx", kSpeed},        {"vy", kSpeed},        {"vz", kSpeed},
    {"wx", kAngularSpeed}, {"wy", kAngularSpeed}, {"wz", kAngularSpeed}, {"ax", kAcceleration}, {"ay", kAcceleration},
    {"az", kAcceleration}, {"fx", kForceUnit},    {"fy", kForceUnit},    {"fz", kForceUnit},    {"tx", kTorque},
    {"ty", kTorque},       {"tz", kTorque},       {"px", kAnyQuantity},  {"py", kAnyQuantity},  {"pz", kAnyQuantity},
    {"lx", kAnyQuantity},  {"ly", kAnyQuantity},  {"lz", kAnyQuantity},  {"fastest", kSpeed}};
constexpr std::string_view kForceParts = " fx fy fz tx ty tz ", kPoseParts = " x y z qw qx qy qz ",
                           kVelocityParts = " vx vy vz ", kMotionParts = " px py pz lx ly lz fastest ",
                           kBodyParts = " x y z qw qx qy qz vx vy vz wx wy wz ax ay az fx fy fz tx ty tz ";

/// The columns of one model or probe.
std::vector<std::string> columns_of(const std::string& name, std::string_view parts) {
  std::vector<std::string> columns;
  for (const auto& part : kParts) {
    if (parts.find(fmt::format(" {} ", part.name)) != std::string_view::npos)
      columns.push_back(fmt::format("{}.{}", name, part.name));
  }
  return columns;
}

std::vector<std::string> columns_of(const Probe& probe) {
  switch (probe.kind) {
    case ProbeKind::kForce:
      return columns_of(probe.name, kForceParts);
    case ProbeKind::kPose:
      return columns_of(probe.name, kPoseParts);
    case ProbeKind::kVelocity:
      return columns_of(probe.name, kVelocityParts);
    case ProbeKind::kMotion:
      return columns_of(probe.name, kMotionParts);
    default:
      return {probe.name};
  }
}

/// The key of a probe that names a fluid; empty for the others.
std::string_view fluid_key(ProbeKind kind) {
  switch (kind) {
    case ProbeKind::kPressureError:
      return "pressure_error";
    case ProbeKind::kMotion:
      return "motion_of";
    case ProbeKind::kVoid:
      return "void_in";
    default:
      return "";
  }
}

/// The columns of everything named `owner`, or where nothing is, the names of all that has columns.
std::vector<std::string> columns_near(const Scene& scene, const std::string& owner) {
  std::vector<std::string> columns, owners;
  for (const Probe& probe : scene.probes) {
    owners.push_back(probe.name);
    if (probe.name == owner) {
      for (auto& column : columns_of(probe)) columns.push_back(std::move(column));
    }
  }
  for (const Model& model : scene.models) {
    if (model.motion == Motion::kStatic) continue;
    owners.push_back(model.name);
    if (model.name == owner) {
      for (auto& column : columns_of(model.name, kBodyParts)) columns.push_back(std::move(column));
    }
  }
  return columns.empty() ? owners : columns;
}

class MeasurementChecker {
 public:
  MeasurementChecker(const Scene& scene, ReadState& state) : scene_(scene), state_(state), models_(model_names(scene)) {
    for (const Fluid& fluid : scene.fluids) fluids_.push_back(fluid.name);
  }

  void run() {
    for (const Probe& probe : scene_.probes) check(probe);
    for (const Expect& expect : scene_.expects) check(expect);
  }

 private:
  using Keys = std::initializer_list<std::string_view>;

  void known(const std::string& name, const std::vector<std::string>& names, std::string_view what, const Place& base,
             Keys keys) {
    if (std::find(names.begin(), names.end(), name) != names.end()) return;
    state_.fail(state_.find(base, keys), fmt::format("there is no {} '{}'", what, name), suggestion(name, names));
  }

  void check(const Probe& probe) {
    if (probe.kind == ProbeKind::kForce) known(probe.target, models_, "model", probe.place, {"force_on"});
    if (probe.kind == ProbeKind::kPose) known(probe.target, models_, "model", probe.place, {"pose_of"});
    const std::string_view of_fluid = fluid_key(probe.kind);
    if (!of_fluid.empty()) known(probe.target, fluids_, "fluid", probe.place, {of_fluid});
    if (!probe.frame.empty()) {
      known(probe.frame, models_, "model", probe.place, {"moves_with"});
      for (const Model& model : scene_.models)
        if (model.name == probe.frame && model.motion == Motion::kDynamic)
          state_.fail(
              state_.find(probe.place, {"moves_with"}),
              fmt::format("the model '{}' moves freely: a place in it would not be one in its frame", model.name),
              "Name a static or prescribed model.");
    }
    const bool needs_fluid = probe.kind != ProbeKind::kPose && of_fluid.empty();
    if (needs_fluid && scene_.fluids.empty()) {
      state_.fail(probe.place, fmt::format("the probe '{}' measures a fluid, but the scene has none", probe.name),
                  "Add a fluid, or remove the probe.");
    }
  }

  /// Number of models that the pattern names; a pattern that names none is an error.
  int matching(const std::string& pattern, bool movable, const Place& base, Keys keys) {
    int count = 0, fixed = 0;
    for (const Model& model : scene_.models) {
      if (fnmatch(pattern.c_str(), model.name.c_str(), 0) != 0) continue;
      ++(movable && model.motion == Motion::kStatic ? fixed : count);
    }
    if (count > 0) return count;
    const auto at = state_.find(base, keys);
    if (fixed > 0) {
      state_.fail(at, fmt::format("'{}' names only static models, which never move", pattern),
                  "Name models that can move.");
    } else {
      state_.fail(at, fmt::format("no model matches '{}'", pattern), suggestion(pattern, models_));
    }
    return 0;
  }

  void check_column(const Expect& expect, std::string_view key) {
    const std::string owner = expect.column.substr(0, expect.column.rfind('.'));
    const auto columns = columns_near(scene_, owner);
    const bool is_column = std::find(columns.begin(), columns.end(), expect.column) != columns.end();
    const bool dotted = owner != expect.column;
    const bool is_plain_probe = std::any_of(scene_.probes.begin(), scene_.probes.end(), [&](const Probe& probe) {
      return probe.name == expect.column && columns_of(probe).front() == probe.name;
    });
    if (dotted ? is_column : is_plain_probe) return;
    const auto place = state_.find(expect.place, {key, "of"});
    for (const Model& model : scene_.models) {
      if (model.name != owner || model.motion != Motion::kStatic) continue;
      return state_.fail(place, fmt::format("'{}' is static and has no columns in bodies.csv", owner),
                         "Add a probe with force_on and use its columns.");
    }
    state_.fail(place, fmt::format("there is no column '{}'", expect.column), suggestion(expect.column, columns));
  }

  void check_bounds(const Expect& expect) {
    const auto place = state_.find(expect.place, {"column"});
    const bool within = expect.within || expect.within_relative;
    if (expect.equals.has_value() != within) {
      state_.fail(place, within ? "within has no target" : "equals has no tolerance",
                  within ? "Add equals." : "Add within, such as 4 %.");
    }
    if (expect.equals && *expect.equals == 0 && expect.within_relative) {
      state_.fail(state_.find(place, {"within"}), "a tolerance in % of a target of 0 allows nothing",
                  "Give within as an absolute value.");
    }
    if (!expect.equals && !expect.below && !expect.above) {
      state_.fail(place, "the column is not compared with anything", "Add equals and within, or below, or above.");
    }
    if (expect.below && expect.above && !(*expect.above < *expect.below)) {
      state_.fail(place, fmt::format("nothing is above {} and below {}", *expect.above, *expect.below),
                  "Let above be less than below.");
    }
  }

  /// A window that the run does not reach, or not to its end, would be judged on rows that are not there.
  void check_window(const Expect& expect) {
    const double end = scene_.world.duration * (1 + 1e-12);
    const bool from = expect.from > end, to = expect.to > end && expect.to < 1e299;
    if (!from && !to) return;
    Place place = expect.place;
    for (const std::string_view kind : {"column", "initial_acceleration", "jitter", "track"}) {
      const Place found = state_.find(expect.place, {kind, from ? "from" : "to"});
      if (found.line != expect.place.line || found.column != expect.place.column) place = found;
    }
    state_.fail(place,
                fmt::format("the window {} at {:g} s, after the end of the run: world.duration is {:g} s",
                            from ? "begins" : "ends", from ? expect.from : expect.to, scene_.world.duration),
                "Make world.duration (--duration) longer, or run without expectations (--no-expect).");
  }

  void check(const Expect& expect) {
    using enum ExpectKind;
    const Place& base = expect.place;
    if (!(expect.from < expect.to)) {
      state_.fail(base, fmt::format("no sample lies between from ({} s) and to ({} s)", expect.from, expect.to),
                  "Let from be before to.");
    }
    check_window(expect);
    switch (expect.kind) {
      case kLostParticles:
        break;
      case kMomentum:
        break;
      case kTotalMomentum:
        if (scene_.world.gravity.norm() > 0 ||
            std::ranges::any_of(scene_.models, [](const Model& m) { return m.motion != Motion::kDynamic; }))
          state_.fail(base, "total momentum changes by gravity, static and prescribed models",
                      "Use it in scenes of free bodies without gravity.");
        break;
      case kMoved:
        check_moved(expect);
        break;
      case kInside:
        check_inside(expect);
        break;
      case kColumn:
        check_column(expect, "column");
        check_bounds(expect);
        break;
      case kInitialAcceleration:
        matching(expect.models, true, base, {"initial_acceleration", "model"});
        known(expect.fluid, fluids_, "fluid", base, {"initial_acceleration", "fluid"});
        break;
      case kJitter:
        matching(expect.models, true, base, {"jitter", "model"});
        break;
      case kTrack:
        check_column(expect, "track");
        break;
    }
  }

  void check_moved(const Expect& expect) {
    const int count = matching(expect.models, true, expect.place, {"moved", "models"});
    if (state_.error || count >= expect.at_least) return;
    state_.fail(state_.find(expect.place, {"moved", "at_least"}),
                fmt::format("{} models are to move, but '{}' names only {}", expect.at_least, expect.models, count),
                fmt::format("Use at most {}.", count));
  }

  void check_inside(const Expect& expect) {
    matching(expect.models, true, expect.place, {"inside", "models"});
    known(expect.container, models_, "model", expect.place, {"inside", "container"});
    for (const Model& model : scene_.models) {
      if (model.name != expect.container || can_contain(model.shape)) continue;
      state_.fail(state_.find(expect.place, {"inside", "container"}),
                  fmt::format("the model '{}' has no inside", model.name),
                  "Use a model with the shape open_box, hollow_sphere, hollow_cylinder or mesh.");
    }
  }

  const Scene& scene_;
  ReadState& state_;
  std::vector<std::string> models_, fluids_;
};

}  // namespace

Quantity column_quantity(std::string_view column) {
  const size_t dot = column.rfind('.');
  if (dot == std::string_view::npos) return kAnyQuantity;  // a probe of whatever kind
  for (const Part& part : kParts) {
    if (part.name == column.substr(dot + 1)) return part.quantity;
  }
  return kAnyQuantity;
}

void check_measurements(const Scene& scene, ReadState& state) { MeasurementChecker(scene, state).run(); }

}  // namespace ballast::scene
