// Expectations on the paths of bodies: moved, inside, initial acceleration, jitter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/output/columns.h"
#include "launch/expect.h"

namespace ballast::launch {

using nlohmann::json;

namespace {

/// Moving models that fit a pattern: place in the rows and index in the scene.
struct Chosen {
  std::size_t row_body, model;
};

std::vector<Chosen> choose(const Scene& scene, const std::string& pattern) {
  std::vector<Chosen> out;
  const std::vector<int> moving = output::moving_models(scene);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    const auto model = static_cast<std::size_t>(moving[i]);
    if (matches(pattern, scene.models[model].name)) out.push_back({i, model});
  }
  return out;
}

Vec3 vec3_at(const Table& rows, std::size_t row, std::size_t body, std::size_t offset) {
  const std::size_t first = body * output::kBodyValues + offset;
  return {rows.at(row, first), rows.at(row, first + 1), rows.at(row, first + 2)};
}

/// Poses of a model's body frame at every row; a static model stands where it was put (one pose).
std::vector<Pose> poses_of(const Evidence& evidence, std::size_t model) {
  std::vector<Pose> out;
  const Table& t = evidence.body_rows;
  for (const Chosen& c : choose(evidence.scene, "*")) {
    if (c.model != model) continue;
    const std::size_t q = c.row_body * output::kBodyValues + 3;
    for (std::size_t row = 0; row < t.rows(); ++row) {
      out.push_back(
          {vec3_at(t, row, c.row_body, 0), Quat(t.at(row, q), t.at(row, q + 1), t.at(row, q + 2), t.at(row, q + 3))});
    }
  }
  if (out.empty()) out.push_back(evidence.bodies[model].pose);
  return out;
}

}  // namespace

Verdict judge_moved(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = fmt::format("{} moved by {:.4g} m", expect.models, expect.by)};
  v.low = expect.at_least;
  const Table& rows = evidence.body_rows;
  if (rows.rows() == 0) {
    v.note = "there are no rows of bodies";
  } else {
    v.value = 0;
    for (const Chosen& c : choose(evidence.scene, expect.models)) {
      const Vec3 way = vec3_at(rows, rows.rows() - 1, c.row_body, 0) - vec3_at(rows, 0, c.row_body, 0);
      if (way.norm() >= expect.by) v.value += 1;
    }
  }
  decide(v);
  return v;
}

Verdict judge_inside(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = fmt::format("outside {}", expect.container)};
  v.high = 0;
  const auto& models = evidence.scene.models;
  const auto found = std::ranges::find(models, expect.container, &Model::name);
  const auto container = static_cast<std::size_t>(found - models.begin());
  if (found == models.end() || !evidence.bodies[container].solid.is_container()) {
    v.note = "there is no container of that name";
    decide(v);
    return v;
  }
  double outside = 0;
  const std::vector<Pose> rooms = poses_of(evidence, container);
  for (const Chosen& c : choose(evidence.scene, expect.models)) {
    if (c.model == container) continue;
    for (std::size_t row = 0; row < evidence.body_rows.rows(); ++row) {
      const Pose& room = rooms[std::min(row, rooms.size() - 1)];
      const Vec3 local = room.rotation.conjugate() * (vec3_at(evidence.body_rows, row, c.row_body, 0) - room.position);
      if (evidence.bodies[container].solid.room_distance(local) < 0) continue;
      outside += 1;
      v.note = fmt::format("{} is outside at t = {:.4g} s", models[c.model].name, evidence.body_rows.times[row]);
      break;
    }
  }
  const json particles = evidence.fluid.value("particles", json::object());
  for (const char* key : {"outside", "lost"}) {
    if (!particles.contains(key)) continue;
    outside += particles[key].get<double>();
    break;
  }
  if (particles.empty() && !evidence.scene.fluids.empty()) {
    outside = std::numeric_limits<double>::quiet_NaN();
    v.note = "the fluid process did not report its particles";
  }
  v.value = outside;
  decide(v);
  return v;
}

Verdict judge_initial_acceleration(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = "initial acceleration of " + expect.models};
  const auto& fluids = evidence.scene.fluids;
  const auto fluid =
      std::ranges::find_if(fluids, [&](const Fluid& f) { return expect.fluid.empty() || f.name == expect.fluid; });
  const Vec3 gravity = evidence.scene.world.gravity;
  if (fluid == fluids.end() || gravity.norm() <= 0) {
    v.note = "it needs the fluid named and gravity";
    decide(v);
    return v;
  }
  double worst = -1;
  for (const Chosen& c : choose(evidence.scene, expect.models)) {
    const double volume = evidence.bodies[c.model].solid.mass_properties().volume;
    if (volume <= 0 || evidence.bodies[c.model].mass <= 0) continue;
    // a = g (r - 1) / (r + C): weight less buoyancy moves the body and the fluid it carries along.
    const double r = evidence.bodies[c.model].mass / volume / fluid->density;
    const double exact = gravity.norm() * (r - 1) / (r + expect.coefficient);
    Series speed;
    for (std::size_t row = 0; row < evidence.body_rows.rows(); ++row) {
      const double t = evidence.body_rows.times[row];
      if (t < expect.from - 1e-9 || t > expect.to + 1e-9) continue;
      speed.times.push_back(t);
      speed.values.push_back(vec3_at(evidence.body_rows, row, c.row_body, 7).dot(gravity.normalized()));
    }
    const double measured = slope(speed);
    const double tolerance = std::max(expect.within.value_or(0), expect.within_relative.value_or(0) * std::abs(exact));
    const double miss = std::isfinite(measured) ? std::abs(measured - exact) : std::numeric_limits<double>::infinity();
    if (miss <= worst) continue;
    worst = miss;
    v.value = measured;
    v.low = exact - tolerance;
    v.high = exact + tolerance;
    if (!std::isfinite(measured)) v.note = "fewer than two rows lie in the window of time";
  }
  if (worst < 0) v.note = "no dynamic model fits";
  decide(v);
  return v;
}

Verdict judge_jitter(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = "jitter of " + expect.models + " (g)"};
  const double g = evidence.scene.world.gravity.norm();
  const Table& rows = evidence.body_rows;
  if (g <= 0) v.note = "it is measured in multiples of gravity, and there is none";
  for (const Chosen& c : choose(evidence.scene, expect.models)) {
    // Accelerations in the rows are those of single steps, so steps that shake show although rows are far apart.
    std::optional<Vec3> before;
    for (std::size_t row = 0; row < rows.rows() && g > 0; ++row) {
      if (rows.times[row] < expect.from - 1e-9 || rows.times[row] > expect.to + 1e-9) continue;
      const Vec3 now = vec3_at(rows, row, c.row_body, 13);
      if (before) {
        const double change = (now - *before).norm() / g;
        if (!std::isfinite(change)) v.note = "an acceleration is not finite";
        v.value = std::isnan(v.value) ? change : std::max(v.value, change);
      }
      before = now;
    }
  }
  if (!v.note.empty())
    v.value = std::numeric_limits<double>::quiet_NaN();
  else if (std::isnan(v.value))
    v.note = "fewer than two rows lie in the window of time";
  set_bounds(v, expect, 1, std::nullopt);
  decide(v);
  return v;
}

/// Fluid from its final report, bodies from the first and the last row.
Verdict judge_total_momentum(const Expect& expect, const Evidence& evidence) {
  Verdict v{.name = "drift of total momentum"};
  const Table& rows = evidence.body_rows;
  const json ledger = evidence.fluid.value("ledger", json::object());
  if (rows.rows() < 2 || !ledger.contains("momentum_start") || !ledger.contains("momentum_end")) {
    v.note = "the fluid's ledger or the rows of bodies are missing";
  } else {
    Vec3 change = Vec3::Zero();
    double scale = 0;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const double start = ledger["momentum_start"][axis], end = ledger["momentum_end"][axis];
      change[k] = end - start;
      scale += start * start;
    }
    scale = std::sqrt(scale);
    for (const Chosen& c : choose(evidence.scene, "*")) {
      const Vec3 start = vec3_at(rows, 0, c.row_body, 7), end = vec3_at(rows, rows.rows() - 1, c.row_body, 7);
      change += evidence.bodies[c.model].mass * (end - start);
      scale += evidence.bodies[c.model].mass * start.norm();
    }
    v.value = change.norm() / scale;
  }
  set_bounds(v, expect, 1, std::nullopt);
  decide(v);
  return v;
}

}  // namespace ballast::launch
