// Pressure of the films between solids in contact.
#include "fluid_server/boundary/seepage.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace ballast::fluid {

namespace {

constexpr double kNarrow = 0.5, kWide = 1.0;  // gap in spacings up to which a film counts fully, and not at all
constexpr double kRough = 0.05;               // gap of solids that touch, spacings: what is left open at corners
constexpr double kBeside = 1.5;               // distance of neighbouring places, spacings
constexpr double kFirstLayer = 0.7;           // share of a wet face's force that its first layer of samples bears

}  // namespace

Seepage::Seepage(const Scene& scene, const Samples& samples, std::span<const Body> bodies, const Vec3& gravity,
                 double density)
    : bodies_(bodies), samples_(samples), spacing_(scene.world.spacing), density_(density), weight_(density * gravity) {
  wrenches_.resize(bodies.size());
  for (const Body& body : bodies) {
    const Box3 box = body.solid.bounds();
    reach_.push_back(box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).norm());
  }
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    if (scene.models[b].motion != Motion::kDynamic) continue;
    Face face{b, {}};
    for (std::uint32_t k = samples.first[b]; k < samples.first[b + 1]; ++k) {
      const std::uint32_t s = samples.order[k];
      if (samples.depth[s] < 0.75 * spacing_)
        face.places.push_back({s, samples.volume[s] / (2 * samples.depth[s]), {}});
    }
    const auto local = [&](std::uint32_t place) { return samples.local[face.places[place].sample]; };
    std::vector<std::uint32_t> by_x(face.places.size());
    std::iota(by_x.begin(), by_x.end(), 0u);
    std::sort(by_x.begin(), by_x.end(), [&](auto i, auto j) { return local(i)[0] < local(j)[0]; });
    const float beside = static_cast<float>(kBeside * spacing_);
    for (std::size_t i = 0; i < by_x.size(); ++i)
      for (std::size_t j = i + 1; j < by_x.size() && local(by_x[j])[0] - local(by_x[i])[0] < beside; ++j)
        if ((local(by_x[i]) - local(by_x[j])).norm() < beside) {
          face.places[by_x[i]].neighbours.push_back(by_x[j]);
          face.places[by_x[j]].neighbours.push_back(by_x[i]);
        }
    faces_.push_back(std::move(face));
  }
}

void Seepage::solve(std::span<const exchange::BodyState> states,
                    const std::function<std::optional<Wet>(std::uint32_t)>& wet) {
  films_.clear();
  for (const Face& face : faces_) {
    if (!cover(face, states)) continue;
    const auto column = [&](const Vec3& point) { return weight_.dot(point - Vec3::Map(states[face.body].position)); };
    for (std::size_t i = 0; i < covered_.size(); ++i) {
      Covered& c = covered_[i];
      if (!(c.share > 0)) continue;
      const Place& place = face.places[i];
      const std::optional<Wet> found = wet(place.sample);
      if (!found) continue;
      c.known = c.reached = true;
      c.head = found->pressure - column(c.point - samples_.depth[place.sample] * c.normal);
      c.share *= std::clamp(1 + found->area.dot(c.normal) / (kFirstLayer * place.area), 0.0, 1.0);
    }
    spread(face);
    for (std::size_t i = 0; i < covered_.size(); ++i) {
      const Covered& c = covered_[i];
      if (!c.reached) continue;
      const double p = std::max(c.head + column(c.point), 0.0);  // a film bears no tension
      const double area = c.share * face.places[i].area;
      const Vec3 force = -p * area * c.normal;
      Film& film = this->film(face.body, c.other);
      film.force += p * area;
      film.area += area;
      film.gap += area * c.gap;
      film.point += p * area * c.point;
      film.normal += p * area * c.normal;
      const auto add = [&](Vector6& wrench, std::uint32_t body, double sign) {
        wrench.head<3>() += sign * force;
        wrench.tail<3>() += (c.point - Vec3::Map(states[body].position)).cross(sign * force);
      };
      add(film.on_body, film.body, 1);
      add(film.on_other, film.other, -1);
    }
  }
}

Seepage::Film& Seepage::film(std::uint32_t body, std::uint32_t other) {
  for (Film& film : films_)
    if (film.body == body && film.other == other) return film;
  Film& film = films_.emplace_back();
  film.body = body, film.other = other;
  return film;
}

void Seepage::press(std::span<const exchange::BodyState> states, std::span<const Vector6> without, double dt) {
  std::fill(wrenches_.begin(), wrenches_.end(), exchange::Wrench{});
  for (const Film& film : films_) {
    if (!(film.force > 0)) continue;
    const Vec3 point = film.point / film.force, normal = film.normal.normalized();
    // Speed at which the gap opens along the normal, from twists or accelerations of the two.
    const auto opening = [&](const Vector6& body, const Vector6& other) {
      const auto at = [&](const Vector6& twist, std::uint32_t b) {
        return Vec3(twist.head<3>() + twist.tail<3>().cross(point - Vec3::Map(states[b].position)));
      };
      return normal.dot(at(other, film.other) - at(body, film.body));
    };
    const auto twist = [&](std::uint32_t b) {
      Vector6 v;
      v << Vec3::Map(states[b].velocity), Vec3::Map(states[b].angular_velocity);
      return v;
    };
    const auto moved = [&](std::uint32_t b, const Vector6& wrench) {
      return Vector6(Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(states[b].mobility) * wrench);
    };
    const double free =
        opening(twist(film.body) + dt * without[film.body], twist(film.other) + dt * without[film.other]);
    const double pushed = dt * opening(moved(film.body, film.on_body), moved(film.other, film.on_other));
    const double gap = std::max(film.gap / film.area, 0.0) + kRough * spacing_, way = 0.5 * std::sqrt(film.area);
    const double fastest = gap / way * std::sqrt(2 * film.force / film.area / density_);
    const double share = pushed > 0 ? std::clamp((fastest - free) / pushed, 0.0, 1.0) : 1.0;
    for (const auto& [b, wrench] : {std::pair(film.body, &film.on_body), std::pair(film.other, &film.on_other)}) {
      Vec3::Map(wrenches_[b].force) += share * wrench->head<3>();
      Vec3::Map(wrenches_[b].torque) += share * wrench->tail<3>();
    }
  }
}

/// Which places of a body another solid lies against; false: none. Of two free bodies the first one's places count.
bool Seepage::cover(const Face& face, std::span<const exchange::BodyState> states) {
  const std::uint32_t own = face.body;
  const double wide = kWide * spacing_;
  std::vector<std::uint32_t> near;
  for (std::uint32_t b = 0; b < states.size(); ++b) {
    const bool counted = std::ranges::any_of(faces_, [&](const Face& f) { return f.body == b && b < own; });
    const double distance = (Vec3::Map(states[b].position) - Vec3::Map(states[own].position)).norm();
    if (b != own && !counted && distance < reach_[b] + reach_[own] + wide) near.push_back(b);
  }
  if (near.empty()) return false;
  covered_.assign(face.places.size(), {});
  bool any = false;
  const Quat q = rotation_of(states[own]);
  for (std::size_t i = 0; i < face.places.size(); ++i) {
    Covered& c = covered_[i];
    const std::uint32_t s = face.places[i].sample;
    // Towards the other solid, not along the sample's own normal: a sample at an edge stands for both faces.
    const Vec3 centre = Vec3::Map(states[own].position) + q * samples_.local[s].cast<double>();
    const auto local = [&](std::uint32_t b) {
      return Vec3(rotation_of(states[b]).conjugate() * (centre - Vec3::Map(states[b].position)));
    };
    double least = wide;
    for (const std::uint32_t b : near) {
      const double gap = bodies_[b].solid.distance(local(b)) - samples_.depth[s];
      if (gap < least) least = gap, c.other = b;
    }
    c.gap = least;
    c.share = std::clamp((kWide - least / spacing_) / (kWide - kNarrow), 0.0, 1.0);
    if (!(c.share > 0)) continue;
    c.normal = -(rotation_of(states[c.other]) * bodies_[c.other].solid.normal(local(c.other)));
    c.point = centre + samples_.depth[s] * c.normal;
    any = true;
  }
  return any;
}

/// Head of the covered places that are not wet themselves, from those that are, as far as they hang together: the
/// graph's Laplacian of it is zero.
void Seepage::spread(const Face& face) {
  std::vector<std::uint32_t> open, number(covered_.size(), 0);
  for (std::uint32_t i = 0; i < covered_.size(); ++i)
    if (covered_[i].known) open.push_back(i);
  std::vector<std::uint32_t> unknown;
  while (!open.empty()) {
    const std::uint32_t i = open.back();
    open.pop_back();
    for (const std::uint32_t j : face.places[i].neighbours) {
      Covered& c = covered_[j];
      if (c.reached || !(c.share > 0)) continue;
      c.reached = true;
      number[j] = static_cast<std::uint32_t>(unknown.size());
      unknown.push_back(j);
      open.push_back(j);
    }
  }
  if (unknown.empty()) return;
  const auto n = static_cast<Eigen::Index>(unknown.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (Eigen::Index row = 0; row < n; ++row) {
    const std::uint32_t i = unknown[static_cast<std::size_t>(row)];
    for (const std::uint32_t j : face.places[i].neighbours) {
      if (!covered_[j].reached) continue;
      entries.emplace_back(row, row, 1.0);
      if (covered_[j].known)
        right[row] += covered_[j].head;
      else
        entries.emplace_back(row, static_cast<Eigen::Index>(number[j]), -1.0);
    }
  }
  Eigen::SparseMatrix<double> laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(laplacian);
  const Eigen::VectorXd head = factor.solve(right);
  for (Eigen::Index row = 0; row < n; ++row) covered_[unknown[static_cast<std::size_t>(row)]].head = head[row];
}

std::size_t Seepage::memory() const {
  std::size_t sum = covered_.capacity() * sizeof(Covered);
  for (const Face& face : faces_)
    for (const Place& place : face.places) sum += sizeof(Place) + place.neighbours.capacity() * sizeof(std::uint32_t);
  return sum;
}

}  // namespace ballast::fluid
