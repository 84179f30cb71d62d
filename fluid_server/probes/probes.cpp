// Probes: sums over the particles near a point or a column.
#include "fluid_server/probes/probes.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>

namespace ballast::fluid {

namespace {

struct Near {
  Vec3 offset;  // particle - point, m
  double volume, p, density;
  Vec3 velocity;  // m/s
};

/// The largest sum of a fit's shares without their signs, by which errors of single velocities grow: 1.3 in the fluid
/// with second derivatives, and larger the further the field has to be taken on beyond the particles.
constexpr double kMostShares = 2;

/// Particles within `reach` of the point; along z only if `column` is false.
std::vector<Near> near(const WcsphFluid& fluid, const Vec3& point, double reach, bool column) {
  std::vector<Near> found;
  const Coordinates& c = fluid.coordinates();
  const Fixed3 at = c.to_fixed(point.cwiseMax(c.domain.min).cwiseMin(c.domain.max - 2 * c.quantum));
  const Particles& particles = fluid.particles();
  for (std::size_t f = 0; f < particles.size(); ++f) {
    const Record& r = particles.record[f];
    Vec3 offset = c.difference({r.x, r.y, r.z}, at);
    if (fluid.constants().kernel.dimension == 2) offset[1] = 0;
    const double flat = column ? std::hypot(offset[0], offset[1]) : offset.norm();
    if (flat < reach)
      found.push_back({offset, r.volume, r.p, fluid.fluid_of(particles.id[f]).density, {r.vx, r.vy, r.vz}});
  }
  return found;
}

enum class Fit { kLinear, kQuadratic };

/// Shares of the particles in the value at the point of the field that fits theirs best, weighted by the kernel; none
/// where they do not determine a quadratic one.
std::optional<Eigen::RowVectorXd> shares(const std::vector<Near>& found, const Kernel& kernel, Fit order) {
  const bool quadratic = order == Fit::kQuadratic;
  // Rows sqrt(w) [1, offset / scale, products of its components]. Where particles do not span all directions (by a
  // tenth of the support, half of what they do beside a wall) the linear solution of smallest norm leaves those out.
  const double scale = (quadratic ? 0.25 : 1) * kernel.support;  // 0.25: kernel-weighted rms of an offset's component
  Eigen::MatrixXd terms(found.size(), quadratic ? 10 : 4);
  Eigen::RowVectorXd root(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Vec3 x = found[i].offset / scale;
    root[row] = std::sqrt(found[i].volume * kernel.value(found[i].offset.norm()));
    terms.row(row).head<4>() << 1, x.transpose();
    if (quadratic) terms.row(row).tail<6>() << x.cwiseAbs2().transpose(), x[0] * x[1], x[1] * x[2], x[2] * x[0];
    terms.row(row) *= root[row];
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> fit;
  fit.setThreshold(quadratic ? 0.02 : 0.1).compute(terms);
  if (quadratic && fit.rank() < (kernel.dimension == 2 ? 6 : 10)) return std::nullopt;
  return fit.pseudoInverse().row(0).cwiseProduct(root);
}

double pressure_error(const WcsphFluid& fluid, std::size_t which) {
  const FluidProperties& properties = fluid.filled().fluids[which];
  const double top = fluid.filled().reports[which].top, g = -fluid.constants().gravity[2];
  const Particles& particles = fluid.particles();
  double sum = 0, lowest = top;
  std::size_t count = 0;
  for (std::size_t f = 0; f < particles.size(); ++f) {
    if (&fluid.fluid_of(particles.id[f]) != &properties) continue;
    const Record& r = particles.record[f];
    const double z = fluid.coordinates().to_metres(r.x, r.y, r.z)[2];
    const double error = r.p - properties.density * g * (top - z);
    sum += error * error;
    lowest = std::min(lowest, z);
    ++count;
  }
  const double bottom = properties.density * g * (top - lowest + 0.5 * fluid.spacing());
  return count && bottom > 0 ? std::sqrt(sum / static_cast<double>(count)) / bottom : 0;
}

std::size_t index_of(const Scene& scene, const std::string& model) {
  for (std::size_t b = 0; b < scene.models.size(); ++b)
    if (scene.models[b].name == model) return b;
  return 0;  // the scene reader has checked the name
}

std::size_t fluid_index(const Scene& scene, const std::string& fluid) {
  for (std::size_t k = 0; k < scene.fluids.size(); ++k)
    if (scene.fluids[k].name == fluid) return k;
  return 0;  // the scene reader has checked the name
}

/// Where the probe is now in the world, m.
Vec3 place_of(const Scene& scene, const Probe& probe, std::span<const exchange::BodyState> states) {
  if (probe.frame.empty()) return probe.at;
  const exchange::BodyState& frame = states[index_of(scene, probe.frame)];
  return Vec3::Map(frame.position) + rotation_of(frame) * probe.at;
}

}  // namespace

double surface_level(const WcsphFluid& fluid, double x, double y) {
  const Kernel& kernel = fluid.constants().kernel;
  const Coordinates& c = fluid.coordinates();
  auto column = near(fluid, {x, y, c.domain.min[2]}, kernel.support, true);
  if (column.empty()) return c.domain.min[2];
  double top = 0;
  for (const Near& n : column) top = std::max(top, n.offset[2]);
  const auto filled = [&](double z) {
    double sum = 0;
    for (const Near& n : column) {
      const double r = std::hypot(n.offset[0], n.offset[1], n.offset[2] - z);
      if (r < kernel.support) sum += n.volume * kernel.value(r);
    }
    return sum;
  };
  const double step = 0.1 * fluid.spacing();
  double high = top + kernel.support, low = high - step;
  while (low > 0 && filled(low) < 0.5) high = low, low -= step;
  for (int k = 0; k < 30; ++k) (filled(0.5 * (low + high)) < 0.5 ? high : low) = 0.5 * (low + high);
  return c.domain.min[2] + 0.5 * (low + high);
}

double pressure_at(const WcsphFluid& fluid, const Vec3& point) {
  const Kernel& kernel = fluid.constants().kernel;
  const Vec3 gravity(fluid.constants().gravity[0], fluid.constants().gravity[1], fluid.constants().gravity[2]);
  double weight = 0, sum = 0;
  for (const Near& n : near(fluid, point, kernel.support, false)) {
    const double w = n.volume * kernel.value(n.offset.norm());
    weight += w;
    sum += w * (n.p - n.density * gravity.dot(n.offset));
  }
  return weight > 0 ? sum / weight : 0;
}

Vec3 velocity_at(const WcsphFluid& fluid, const Vec3& point) {
  const Kernel& kernel = fluid.constants().kernel;
  const auto found = near(fluid, point, kernel.support, false);
  if (found.empty()) return Vec3::Zero();
  auto share = shares(found, kernel, Fit::kQuadratic);
  if (!share || share->lpNorm<1>() > kMostShares) share = shares(found, kernel, Fit::kLinear);
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < found.size(); ++i) sum += (*share)[static_cast<Eigen::Index>(i)] * found[i].velocity;
  return sum;
}

std::array<double, 7> motion_of(const WcsphFluid& fluid, std::size_t which) {
  const FluidProperties& properties = fluid.filled().fluids[which];
  const Particles& particles = fluid.particles();
  Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();
  double fastest = 0;
  for (std::size_t f = 0; f < particles.size(); ++f) {
    if (&fluid.fluid_of(particles.id[f]) != &properties) continue;
    const Record& r = particles.record[f];
    const Vec3 x = fluid.coordinates().to_metres(r.x, r.y, r.z), v(r.vx, r.vy, r.vz);
    const double mass = properties.density * r.volume;
    momentum += mass * v;
    angular += mass * x.cross(v);
    fastest = std::max(fastest, v.norm());
  }
  return {momentum[0], momentum[1], momentum[2], angular[0], angular[1], angular[2], fastest};
}

std::vector<double> read_probes(const Scene& scene, const WcsphFluid& fluid,
                                std::span<const exchange::BodyState> states) {
  std::vector<double> row;
  for (const Probe& probe : scene.probes) {
    const std::size_t target = index_of(scene, probe.target);
    const Vec3 at = place_of(scene, probe, states);
    switch (probe.kind) {
      case ProbeKind::kLevel:
        row.push_back(surface_level(fluid, at[0], at[1]));
        break;
      case ProbeKind::kPressure:
        row.push_back(pressure_at(fluid, at));
        break;
      case ProbeKind::kVelocity: {
        const Vec3 v = velocity_at(fluid, at);
        row.insert(row.end(), v.begin(), v.end());
        break;
      }
      case ProbeKind::kForce: {
        const exchange::Wrench& w = fluid.wrenches()[target];
        row.insert(row.end(), w.force, w.force + 3);
        row.insert(row.end(), w.torque, w.torque + 3);
        break;
      }
      case ProbeKind::kPose:
        row.insert(row.end(), states[target].position, states[target].position + 3);
        row.insert(row.end(), states[target].orientation, states[target].orientation + 4);
        break;
      case ProbeKind::kPressureError:
        row.push_back(pressure_error(fluid, fluid_index(scene, probe.target)));
        break;
      case ProbeKind::kMotion: {
        const auto motion = motion_of(fluid, fluid_index(scene, probe.target));
        row.insert(row.end(), motion.begin(), motion.end());
        break;
      }
      case ProbeKind::kVoid:
        row.push_back(largest_void(fluid, fluid_index(scene, probe.target)));
        break;
    }
  }
  return row;
}

std::size_t count_inside(const Body& body, const Pose& pose, const WcsphFluid& fluid) {
  const Box3 bounds = body.solid.bounds();
  std::size_t inside = 0;
  for (const Record& r : fluid.particles().record) {
    const Vec3 local = pose.rotation.conjugate() * (fluid.coordinates().to_metres(r.x, r.y, r.z) - pose.position);
    if (((local - bounds.min).array() >= 0).all() && ((bounds.max - local).array() >= 0).all() &&
        body.solid.distance(local) < 0)
      ++inside;
  }
  return inside;
}

std::size_t count_misplaced(const Scene& scene, const std::vector<Body>& bodies, const WcsphFluid& fluid,
                            std::span<const exchange::BodyState> states) {
  const double tolerance = 0.5 * fluid.spacing();
  bool contained = false;  // a hull that floats holds nothing back
  for (std::size_t b = 0; b < bodies.size(); ++b)
    contained |= bodies[b].solid.is_container() && scene.models[b].motion != Motion::kDynamic;
  const Particles& particles = fluid.particles();
  std::size_t misplaced = 0;
#pragma omp parallel for num_threads(fluid.constants().threads) schedule(static) reduction(+ : misplaced)
  for (std::size_t f = 0; f < particles.size(); ++f) {
    const Record& r = particles.record[f];
    const Vec3 p = fluid.coordinates().to_metres(r.x, r.y, r.z);
    bool held = !contained, inside = false;
    for (std::size_t b = 0; b < bodies.size() && !inside; ++b) {
      const Vec3 position = Vec3::Map(states[b].position);
      const Quat q = rotation_of(states[b]);
      const Vec3 local = q.conjugate() * (p - position);
      const Box3 bounds = bodies[b].solid.bounds();
      if (bodies[b].solid.is_container())
        held |= bodies[b].solid.room_distance(local) < tolerance;
      else if (((local - bounds.min).array() >= 0).all() && ((bounds.max - local).array() >= 0).all())
        inside = bodies[b].solid.distance(local) < -tolerance;
    }
    if (inside || !held) ++misplaced;
  }
  return misplaced;
}

}  // namespace ballast::fluid
