// Checks of models, fluids, joints and dimension 2. Each complaint carries the place of the value that it is about.
#include "common/scene/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "common/scene/nearest.h"

namespace ballast::scene {
namespace {

constexpr double kMostModels = 100'000;
constexpr double kMostSteps = 1e12;
constexpr double kLeastSupport = 2;  // spacings
constexpr double kLeastPeriod =
    6;  // spacings: three of the smallest kernel's supports; the fluid wants three of its own

class Checker {
 public:
  Checker(const Scene& scene, const Place& root, ReadState& state) : scene_(scene), root_(root), state_(state) {
    for (const Model& model : scene.models) models_.try_emplace(model.name, &model);
  }

  void run() {
    check_world();
    unique("fluid", scene_.fluids);
    unique("model", scene_.models);
    unique("joint", scene_.joints);
    unique("probe", scene_.probes);
    for (const Fluid& fluid : scene_.fluids) check_fluid(fluid);
    for (const Model& model : scene_.models) check_model(model);
    for (const Joint& joint : scene_.joints) check_joint(joint);
    if (scene_.world.dimension == 2) check_plane();
    check_reduced_gravity();
    if (scene_.numerics.pressure == Pressure::kImplicit && scene_.coupling.scheme == "staggered")
      fail(root_, {"coupling", "scheme"},
           "the implicit solver moves bodies with their mobility: it knows no staggered scheme",
           "Use interlinked or iterated, or numerics.pressure: wcsph.");
    if (const double support = scene_.numerics.support; support != 0 && support < kLeastSupport)
      fail(root_, {"numerics", "support"},
           fmt::format("within {:g} spacings a particle has too few neighbours", support),
           fmt::format("Set {:g} to 6, or 0 for what suits the kernel.", kLeastSupport));
    check_attraction();
  }

 private:
  using Keys = std::initializer_list<std::string_view>;

  void fail(const Place& base, Keys keys, std::string what, std::string cure) {
    state_.fail(state_.find(base, keys), std::move(what), std::move(cure));
  }

  template <class T>
  void unique(std::string_view kind, const std::vector<T>& items) {
    std::unordered_map<std::string, const T*> seen;
    for (const T& item : items) {
      const auto [it, fresh] = seen.try_emplace(item.name, &item);
      if (fresh) continue;
      fail(item.place, {"name"},
           fmt::format("a {} named '{}' exists already, at {}", kind, item.name, where(it->second->place)),
           "Give each one a name of its own.");
    }
  }

  /// The field acts in the explicit step only, and on no body: what it cannot do is refused, not left out.
  void check_attraction() {
    if (scene_.world.attraction_rate == 0) {
      if (!scene_.world.attraction_centre.isZero(0))
        fail(root_, {"world", "attraction", "centre"}, "a centre of attraction without a rate attracts nothing",
             "Add world.attraction.rate, in 1/s written as Hz.");
      return;
    }
    if (scene_.numerics.pressure == Pressure::kImplicit)
      fail(root_, {"world", "attraction"}, "the implicit solver knows no attraction",
           "Set numerics.pressure: wcsph, or remove world.attraction.");
    for (const Model& model : scene_.models)
      fail(model.place, {}, fmt::format("the attraction of the fluid would not act on the model '{}'", model.name),
           "Remove world.attraction or the models.");
  }

  void check_reduced_gravity() {
    if (!scene_.numerics.reduced_gravity || scene_.fluids.empty()) return;
    for (const Fluid& fluid : scene_.fluids)
      if (fluid.density != scene_.fluids[0].density)
        fail(fluid.place, {},
             fmt::format("numerics.reduced_gravity needs one density: '{}' has {} kg/m^3, '{}' {} kg/m^3",
                         scene_.fluids[0].name, scene_.fluids[0].density, fluid.name, fluid.density),
             "Set reduced_gravity: false, or give all fluids the same density.");
  }

  void check_box(const Box3& box, std::string_view what, const Place& base, Keys keys) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((axis == 1 && scene_.world.dimension == 2) || box.min[axis] < box.max[axis]) continue;
      fail(base, keys,
           fmt::format("{} is empty along {}: min {} is not below max {}", what, "xyz"[axis], box.min[axis],
                       box.max[axis]),
           "Let min be below max in every axis.");
    }
  }

  void check_world() {
    const World& world = scene_.world;
    const auto& periodic = world.periodic;
    if (world.domain) check_box(*world.domain, "domain", root_, {"world", "domain"});
    if (!world.domain && (periodic[0] || periodic[1] || periodic[2])) {
      fail(root_, {"world", "periodic"}, "periodic axes need a domain, which is not given",
           "Add world.domain: { min: [...], max: [...] }.");
    }
    for (int axis = 0; world.domain && axis < 3; ++axis) {
      const double length = world.domain->max[axis] - world.domain->min[axis];
      if (!periodic[size_t(axis)] || length >= kLeastPeriod * world.spacing) continue;
      fail(root_, {"world", "domain"},
           fmt::format("the domain is {:g} m long on its periodic axis {}, less than {} spacings", length, "xyz"[axis],
                       kLeastPeriod),
           "Make world.domain longer or world.spacing smaller.");
    }
    if (scene_.fluids.empty()) {
      const double steps = world.duration / scene_.coupling.rigid_step;
      if (steps > kMostSteps)
        fail(root_, {"coupling", "rigid_step"},
             fmt::format("{:g} s in steps of {:g} s are {:.2g} steps; {:g} is the most", world.duration,
                         scene_.coupling.rigid_step, steps, kMostSteps),
             "Make coupling.rigid_step larger or world.duration shorter.");
    }
    if (scene_.fluids.empty() && scene_.models.empty()) {
      fail(root_, {}, "the scene has neither fluids nor models", "Add fluids or models.");
    }
    if (!scene_.fluids.empty() && !(world.spacing > 0)) {
      fail(root_, {"world", "spacing"}, "a scene with a fluid needs a particle spacing greater than 0",
           "Add world.spacing, such as 2 cm.");
    }
  }

  const Model* model_named(const std::string& name) const {
    const auto it = models_.find(name);
    return it == models_.end() ? nullptr : it->second;
  }

  void check_fluid(const Fluid& fluid) {
    if (!(fluid.density > 0)) {
      fail(fluid.place, {}, fmt::format("the fluid '{}' has neither material nor density", fluid.name),
           "Add material: water, or density and viscosity.");
    }
    if (fluid.fill.kind == FillKind::kBox) check_box(fluid.fill.box, "the fill", fluid.place, {"fill", "box"});
    if (fluid.fill.kind != FillKind::kLevel) return;
    const std::string& name = fluid.fill.container;
    const Model* container = model_named(name);
    const Keys keys{"fill", "level", "container"};
    if (container == nullptr) {
      fail(fluid.place, keys, fmt::format("container '{}' is not a model", name),
           suggestion(name, model_names(scene_)));
    } else if (!can_contain(container->shape)) {
      fail(fluid.place, keys, fmt::format("the model '{}' has no inside that could hold a fluid", name),
           "Use open_box, hollow_sphere, hollow_cylinder or mesh as its shape.");
    }
  }

  void check_model(const Model& model) {
    if (model.motion == Motion::kDynamic && !(model.density > 0) && !(model.mass > 0)) {
      fail(model.place, {}, fmt::format("the model '{}' has neither density nor mass", model.name),
           "Add one of them, or static: true.");
    }
    if (model.name == "world") {
      fail(model.place, {"name"}, "'world' is the name of the fixed frame, not of a model", "Choose another name.");
    }
    check_walls(model, model.shape);
    const Prescription& p = model.prescription;
    if (!(p.start < p.stop)) {
      fail(model.place, {"prescribed", "stop"},
           fmt::format("the motion stops at {} s, before it starts at {} s", p.stop, p.start),
           "Let start be before stop.");
    }
    if (!p.amplitude.isZero(0) && p.frequency == 0) {
      fail(model.place, {"prescribed", "amplitude"}, "an amplitude without a frequency moves nothing",
           "Add frequency, in Hz.");
    }
    if (p.amplitude.isZero(0) && p.frequency > 0) {
      fail(model.place, {"prescribed", "frequency"}, "a frequency without an amplitude moves nothing",
           "Add amplitude: [x, y, z].");
    }
    if (p.amplitude.isZero(0) && p.phase != 0) {
      fail(model.place, {"prescribed", "phase"}, "a phase without an amplitude moves nothing",
           "Add amplitude: [x, y, z], and frequency.");
    }
  }

  void check_walls(const Model& model, const Shape& shape) {
    if (shape.kind == ShapeKind::kCompound && shape.parts.empty()) {
      fail(model.place, {"shape", "compound"}, "the compound has no parts", "Add { shape: ..., pose: ... }.");
    }
    const bool walled = shape.kind == ShapeKind::kOpenBox || shape.hollow;
    if (walled && shape.wall == 0 && scene_.world.spacing == 0) {
      fail(model.place, {"shape"},
           fmt::format("the walls of '{}' have no thickness: by default it is three spacings", model.name),
           "Set wall, or world.spacing.");
    }
    for (const Part& part : shape.parts) check_walls(model, part.shape);
  }

  void check_joint(const Joint& joint) {
    const Model* child = model_named(joint.child);
    const Model* parent = model_named(joint.parent);
    if (child == nullptr) {
      fail(joint.place, {"child"}, fmt::format("child '{}' is not a model", joint.child),
           suggestion(joint.child, model_names(scene_)));
    } else if (parent == nullptr && joint.parent != "world") {
      auto names = model_names(scene_);
      names.insert(names.begin(), "world");
      fail(joint.place, {"parent"}, fmt::format("parent '{}' is neither a model nor 'world'", joint.parent),
           suggestion(joint.parent, names));
    } else if (parent == child) {
      fail(joint.place, {"child"}, fmt::format("the joint connects '{}' with itself", joint.child),
           "Name two different models.");
    } else if (child->motion != Motion::kDynamic && (parent == nullptr || parent->motion != Motion::kDynamic)) {
      fail(joint.place, {}, fmt::format("neither side of the joint '{}' moves freely", joint.name),
           "Let the child be a model with density or mass, or remove the joint.");
    }
    if (joint.lower && joint.upper && !(*joint.lower < *joint.upper)) {
      fail(joint.place, {"limits"},
           fmt::format("the lower limit {} is not below the upper limit {}", *joint.lower, *joint.upper),
           "Let lower be below upper.");
    } else if (joint.lower.value_or(0) > 0 || joint.upper.value_or(0) < 0) {
      fail(joint.place, {"limits"},
           fmt::format("the limits of joint '{}', which are relative to the start, leave the start itself out ({} {})",
                       joint.name, joint.lower.value_or(0) > 0 ? "lower:" : "upper:",
                       joint.lower.value_or(0) > 0 ? *joint.lower : *joint.upper),
           "Let lower be at most 0 and upper at least 0, or place the bodies where the limits allow it.");
    }
    if (joint.kind == JointKind::kUniversal && std::abs(joint.axis.dot(joint.axis2)) > 1e-6) {
      fail(joint.place, {"axis2"}, "axis2 is not at right angles to axis", "Choose two orthogonal axes.");
    }
    if (joint.motor_velocity != 0 && joint.motor_max_effort == 0) {
      fail(joint.place, {"motor"}, "a motor without max_effort moves nothing", "Add max_effort, in N m or N.");
    }
  }

  // --- dimension 2: the plane is x-z; a key that would be ignored is refused ---

  void in_plane(const Vec3& vector, std::string_view what, const Place& base, Keys keys) {
    if (std::abs(vector.y()) <= 1e-12) return;
    fail(base, keys,
         fmt::format("{} has a component {} along y, but in dimension 2 the plane is x-z", what, vector.y()),
         "Set y to 0.");
  }

  void about_y(const Vec3& vector, std::string_view what, const Place& base, Keys keys) {
    if (std::abs(vector.x()) <= 1e-12 && std::abs(vector.z()) <= 1e-12) return;
    fail(base, keys, fmt::format("{} is not about y, the only axis of rotation in dimension 2", what),
         "Set the other components to 0.");
  }

  void check_plane() {
    in_plane(scene_.world.gravity, "gravity", root_, {"world", "gravity"});
    if (scene_.world.periodic[1]) {
      fail(root_, {"world", "periodic"}, "y cannot be periodic in dimension 2, where the plane is x-z", "Remove y.");
    }
    for (const Fluid& fluid : scene_.fluids) {
      in_plane(fluid.velocity, "velocity", fluid.place, {"velocity"});
      about_y(fluid.angular_velocity, "angular_velocity", fluid.place, {"angular_velocity"});
    }
    for (const Model& model : scene_.models) check_plane(model);
    for (const Joint& joint : scene_.joints) check_plane(joint);
  }

  void check_plane(const Model& model) {
    in_plane(model.pose.position, "pose", model.place, {"pose"});
    about_y(model.pose.rotation.vec(), "the rotation in pose", model.place, {"pose"});
    in_plane(model.velocity, "velocity", model.place, {"velocity"});
    about_y(model.angular_velocity, "angular_velocity", model.place, {"angular_velocity"});
    in_plane(model.prescription.velocity, "velocity", model.place, {"prescribed", "velocity"});
    in_plane(model.prescription.amplitude, "amplitude", model.place, {"prescribed", "amplitude"});
    about_y(model.prescription.angular_velocity, "angular_velocity", model.place, {"prescribed", "angular_velocity"});
    if (model.shape.kind == ShapeKind::kPlane)
      in_plane(model.shape.normal, "normal", model.place, {"shape", "plane", "normal"});
  }

  void check_plane(const Joint& joint) {
    in_plane(joint.anchor, "anchor", joint.place, {"anchor"});
    if (joint.kind == JointKind::kRevolute) about_y(joint.axis, "axis", joint.place, {"axis"});
    if (joint.kind == JointKind::kPrismatic) in_plane(joint.axis, "axis", joint.place, {"axis"});
    if (joint.kind == JointKind::kUniversal) {
      fail(joint.place, {"type"}, "a universal joint turns out of the plane of dimension 2",
           "Use revolute with axis [0, 1, 0].");
    }
  }

  const Scene& scene_;
  const Place& root_;
  ReadState& state_;
  std::unordered_map<std::string, const Model*> models_;
};

}  // namespace

std::vector<std::string> model_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const Model& model : scene.models) names.push_back(model.name);
  return names;
}

bool can_contain(const Shape& shape) {
  return shape.kind == ShapeKind::kOpenBox || shape.kind == ShapeKind::kMesh || shape.hollow;
}

void expand_repeats(Scene& scene, ReadState& state) {
  std::vector<Model> expanded;
  for (size_t i = 0; i < scene.models.size(); ++i) {
    const Model& model = scene.models[i];
    const Repeat& repeat = state.repeats[i];
    const auto& [nx, ny, nz] = repeat.count;
    if (static_cast<double>(expanded.size()) + double(nx) * ny * nz > kMostModels) {
      return state.fail(state.find(model.place, {"repeat", "count"}),
                        fmt::format("the scene has more than {} models", kMostModels), "Repeat less often.");
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (repeat.count[size_t(axis)] > 1 && repeat.step[axis] == 0) {
        return state.fail(state.find(model.place, {"repeat", "step"}),
                          fmt::format("{} copies of '{}' along {} lie at one place", repeat.count[size_t(axis)],
                                      model.name, "xyz"[axis]),
                          "Give the step of this axis, or let its count be 1.");
      }
    }
    for (int j = 0; j < nx * ny * nz; ++j) {
      const int x = j / (ny * nz), y = j / nz % ny, z = j % nz;
      Model& copy = expanded.emplace_back(model);
      if (!repeat.given) continue;
      copy.name = fmt::format("{}_{}_{}_{}", model.name, x, y, z);
      copy.pose.position += Vec3(x, y, z).cwiseProduct(repeat.step);
    }
  }
  scene.models = std::move(expanded);
}

void check_scene(const Scene& scene, const Place& root, ReadState& state) {
  Checker(scene, root, state).run();
  check_measurements(scene, state);
}

}  // namespace ballast::scene
