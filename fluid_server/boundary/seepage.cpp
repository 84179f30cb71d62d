// Pressure of the films between solids in contact.
#include "fluid_server/boundary/seepage.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fluid_server/neighbours/shares.h"

namespace ballast::fluid {

namespace {

constexpr double kNarrow = 0.5, kWide = 1.0;  // gap in spacings up to which a film counts fully, and not at all
// Gap in spacings up to which the particles at a rim lie beside the gap, and from which on they may be pressed into it.
constexpr double kShut = 0.1, kAjar = 0.25;
constexpr double kBesideGap = 0.8;   // gap in spacings of places beside a film, rounded or not
constexpr double kRough = 0.05;      // gap of solids that touch, spacings: what is left open at corners
constexpr double kOneSide = 0.7;     // cosine between normals of one film
constexpr double kBeside = 1.5;      // distance of neighbouring places, spacings
constexpr double kMostChange = 0.5;  // share of a film's area that closing a body may add or take
constexpr int kFilmSweeps = 20;      // over the films of all bodies: stacks of ten
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kFirstLayer = 0.7;  // share of a wet face's force that its first layer of samples bears

}  // namespace

Seepage::Seepage(const Scene& scene, const Samples& samples, std::span<const Body> bodies, const Kernel& kernel,
                 const Vec3& gravity, double density, int threads)
    : bodies_(bodies),
      samples_(samples),
      spacing_(scene.world.spacing),
      threads_(threads),
      density_(density),
      weight_(density * gravity) {
  // Two half spaces on a lattice have n pairs of layers n apart: column (i, j) bears the sum of n V W'/r n d over them.
  const int reach = static_cast<int>(kernel.support / spacing_);
  for (int i = -reach; i <= reach; ++i)
    for (int j = kernel.dimension == 2 ? 0 : -reach; j <= (kernel.dimension == 2 ? 0 : reach); ++j) {
      Column column{i, j, 0};
      for (int n = 1; n <= reach; ++n)
        column.weight -= n * n * kernel.slope_over_r(spacing_ * std::sqrt(n * n + i * i + j * j));
      if (column.weight > 0) columns_.push_back(column);
    }
  double sum = 0;
  for (const Column& column : columns_) sum += column.weight;
  for (Column& column : columns_) column.weight /= sum;
  wrenches_.resize(bodies.size());
  for (const Body& body : bodies) {
    Box3 box = body.solid.bounds();
    reach_.push_back(box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()).norm());
    if (scene.world.dimension == 2) box.min[1] = -kInfinite, box.max[1] = kInfinite;
    bounds_.push_back(box);
  }
  for (std::uint32_t b = 0; b < bodies.size(); ++b) {
    if (scene.models[b].motion != Motion::kDynamic) continue;
    Face face{b, {}, false, {}};
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

void Seepage::solve(std::span<const exchange::BodyState> states, const FindWet& wet) {
  films_.clear();
  closed_.clear();
  for_each_by_turns(faces_.size(), threads_, [&](std::size_t f) {
    Face& face = faces_[f];
    face.has_films = cover(face, states, wet);
    if (!face.has_films) return;
    read_rims(face, states[face.body], wet);
    spread(face);
    const Quat rotation = rotation_of(states[face.body]);
    for (Covered& c : face.covered) {
      if (c.reached && c.trapped) hold_trapped(c, states[face.body]);
      if (c.reached && !counted(face, c.other)) c.bears = c.share * bearing(c, rotation, states[c.other]);
    }
  });
  for (const Face& face : faces_) {
    if (!face.has_films) continue;
    bear(face, states);
    note_closed(face, wet);
  }
  close();
}

/// What is trapped in a gap presses with the pressure that it happens to have; the film bears what it lacks.
void Seepage::hold_trapped(Covered& covered, const exchange::BodyState& state) const {
  const double film = covered.head + column(covered.point, state);
  covered.lacks = film > 0 ? std::clamp(1 - covered.inside / film, 0.0, 1.0) : 0;
  covered.share *= 1 - covered.pressed * (1 - covered.lacks);
}

double Seepage::column(const Vec3& point, const exchange::BodyState& state) const {
  return weight_.dot(point - Vec3::Map(state.position));
}

/// Heads where they are known: of the fluid at wet places, of air at dry ones that lie at the edge of a film.
void Seepage::read_rims(Face& face, const exchange::BodyState& state, const FindWet& wet) const {
  const auto in_air = [&](std::uint32_t j) {
    return !(face.covered[j].gap < kWide * spacing_) && !wet(face.places[j].sample);
  };
  const auto beside = [&](std::uint32_t j) { return face.covered[j].gap > kBesideGap * spacing_; };
  for (std::size_t i = 0; i < face.covered.size(); ++i) {
    Covered& c = face.covered[i];
    if (!(c.share > 0)) continue;
    const Place& place = face.places[i];
    if (const std::optional<Wet> found = wet(place.sample)) {
      const double pressed = std::clamp(-found->area.dot(c.normal) / (kFirstLayer * place.area), 0.0, 1.0);
      // Far inside a gap only what was trapped there is seen: the film bears on it, not it on the film.
      c.trapped = c.gap < kNarrow * spacing_ && std::ranges::none_of(place.neighbours, beside);
      if (c.trapped) {
        c.pressed = pressed, c.inside = found->seen;
        continue;
      }
      c.share *= 1 - pressed;
      c.known = c.reached = true;
      const double shut = std::clamp((kAjar - c.gap / spacing_) / (kAjar - kShut), 0.0, 1.0);
      const double pressure = found->pressure + shut * (found->seen - found->pressure);
      c.head = pressure - column(c.point - samples_.depth[place.sample] * c.normal, state);
    } else if (std::ranges::any_of(place.neighbours, in_air)) {
      c.known = c.reached = c.dry = true;
      c.head = -column(c.point, state);
    }
  }
}

/// Adds up what the places bear, by film.
void Seepage::bear(const Face& face, std::span<const exchange::BodyState> states) {
  for (std::size_t i = 0; i < face.covered.size(); ++i) {
    const Covered& c = face.covered[i];
    if (!c.reached || counted(face, c.other)) continue;
    const double p = std::max(c.head + column(c.point, states[face.body]), 0.0);  // a film bears no tension
    const double area = c.bears * face.places[i].area;
    const Vec3 force = -p * area * c.normal;
    Film& film = this->film(face.body, c.other, c.normal);
    film.force += p * area;
    film.area += area;
    film.gap += area * c.gap;
    film.point += p * area * c.point;
    film.normal += p * area * c.normal;
    film.face += area * c.normal;
    const auto add = [&](Vector6& wrench, std::uint32_t body, double sign) {
      wrench.head<3>() += sign * force;
      wrench.tail<3>() += (c.point - Vec3::Map(states[body].position)).cross(sign * force);
    };
    add(film.on_body, film.body, 1);
    add(film.on_other, film.other, -1);
  }
}

/// Notes what the samples leave open of a body with water or films on every side.
void Seepage::note_closed(const Face& face, const FindWet& wet) {
  for (std::size_t i = 0; i < face.covered.size(); ++i)
    if (!(face.covered[i].reached && !face.covered[i].dry) && !wet(face.places[i].sample)) return;
  Closed& closed = closed_.emplace_back(face.body);
  for (std::uint32_t k = samples_.first[face.body]; k < samples_.first[face.body + 1]; ++k)
    if (const auto found = wet(samples_.order[k])) closed.open += (1 + found->share) * found->area;
  for (std::size_t i = 0; i < face.covered.size(); ++i) {
    const Covered& c = face.covered[i];
    if (!(c.lacks > 0)) continue;
    if (const auto found = wet(face.places[i].sample))
      closed.open -= c.lacks * (1 + found->share) / kFirstLayer * found->area;
  }
}

/// Around such a body a uniform pressure has no force: what its samples do not bear of it, its films do. Their areas
/// are set so, with the least change: they are off where gaps are bent or solids thinner than the kernel, or do not fit
/// the particles.
void Seepage::close() {
  const auto n = static_cast<Eigen::Index>(films_.size()), rows = static_cast<Eigen::Index>(3 * closed_.size());
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(rows, n);
  Eigen::VectorXd open(rows);
  for (Eigen::Index row = 0; row < rows; row += 3) {
    const Closed& closed = closed_[static_cast<std::size_t>(row / 3)];
    Vec3 left = closed.open;
    for (Eigen::Index f = 0; f < n; ++f) {
      const Film& film = films_[static_cast<std::size_t>(f)];
      const double sign = film.body == closed.body ? 1 : film.other == closed.body ? -1 : 0;
      if (sign == 0 || film.face.isZero(0)) continue;
      left -= sign * film.face;
      directions.block<3, 1>(row, f) = sign * film.face.normalized();
    }
    open.segment<3>(row) = left;
  }
  if (rows == 0 || n == 0) return;
  Eigen::MatrixXd square = directions * directions.transpose();
  square.diagonal().array() += 1e-6;  // directions in which no film lies
  const Eigen::VectorXd change = directions.transpose() * square.ldlt().solve(open);
  for (Eigen::Index f = 0; f < n; ++f) {
    Film& film = films_[static_cast<std::size_t>(f)];
    if (!film.face.isZero(0)) film.scale(1 + std::clamp(change[f] / film.face.norm(), -kMostChange, kMostChange));
  }
}

void Seepage::Film::scale(double by) {
  force *= by, area *= by, gap *= by;
  point *= by, normal *= by, face *= by;
  on_body *= by, on_other *= by;
}

/// Share of a place's area that the film bears: the sums over particles reach round its rim and bear the rest. With
/// fluid beside both bodies a strip of the face is borne so, on a wider floor nothing is. It is the force between the
/// samples behind the place and those of the other solid, were both fluid, on a lattice: only columns inside the other
/// one count.
double Seepage::bearing(const Covered& covered, const Quat& rotation, const exchange::BodyState& other) const {
  int axis;
  (rotation.conjugate() * covered.normal).cwiseAbs().minCoeff(&axis);
  const Vec3 across = covered.normal.cross(rotation * Vec3::Unit(axis)).normalized(),
             along = across.cross(covered.normal);
  const Vec3 inside = covered.point + (covered.gap + 0.5 * spacing_) * covered.normal;
  const Quat to_local = rotation_of(other).conjugate();
  double share = 0;
  for (const Column& column : columns_) {
    const Vec3 at = inside + spacing_ * (column.along * along + column.across * across);
    const double distance = bodies_[covered.other].solid.distance(to_local * (at - Vec3::Map(other.position)));
    share += column.weight * std::clamp(0.5 - distance / spacing_, 0.0, 1.0);
  }
  return share;
}

/// In a corner the floor and each wall have a film of their own: water follows each as that gap opens.
Seepage::Film& Seepage::film(std::uint32_t body, std::uint32_t other, const Vec3& normal) {
  for (Film& film : films_)
    if (film.body == body && film.other == other && film.face.dot(normal) >= kOneSide * film.face.norm()) return film;
  Film& film = films_.emplace_back();
  film.body = body, film.other = other;
  return film;
}

void Seepage::press(std::span<const exchange::BodyState> states, std::span<const Vector6> without, double dt) {
  std::fill(wrenches_.begin(), wrenches_.end(), exchange::Wrench{});
  std::erase_if(films_, [](const Film& film) { return !(film.force > 0); });
  std::vector<Vector6> twist(states.size());  // at the end of the step
  for (std::size_t b = 0; b < states.size(); ++b) {
    twist[b] << Vec3::Map(states[b].velocity), Vec3::Map(states[b].angular_velocity);
    twist[b] += dt * without[b];
  }
  struct Valve {
    Film* film;
    double fastest;             // that water can follow, m/s
    Vector6 of_body, of_other;  // opening speed per twist
    Vector6 body, other;        // twist that the whole film gives
    double gain;                // opening speed by that
  };
  std::vector<Valve> valves;
  for (Film& film : films_) {
    const double gap = std::max(film.gap / film.area, 0.0) + kRough * spacing_, way = 0.5 * std::sqrt(film.area);
    Valve v{&film, gap / way * std::sqrt(2 * film.force / film.area / density_), {}, {}, {}, {}, 0};
    const Vec3 point = film.point / film.force, normal = film.normal.normalized();
    v.of_body << -normal, -(point - Vec3::Map(states[film.body].position)).cross(normal);
    v.of_other << normal, (point - Vec3::Map(states[film.other].position)).cross(normal);
    v.body = dt * mobility_of(states[film.body]) * film.on_body;
    v.other = dt * mobility_of(states[film.other]) * film.on_other;
    v.gain = v.of_body.dot(v.body) + v.of_other.dot(v.other);
    valves.push_back(v);
  }
  for (int sweep = 0; sweep < kFilmSweeps; ++sweep)  // projected Gauss-Seidel: each film in turn as far as it may
    for (const Valve& v : valves) {
      Film& film = *v.film;
      const double now = v.of_body.dot(twist[film.body]) + v.of_other.dot(twist[film.other]);
      const double share = v.gain > 0 ? std::clamp(film.share + (v.fastest - now) / v.gain, 0.0, 1.0) : 1.0;
      twist[film.body] += (share - film.share) * v.body;
      twist[film.other] += (share - film.share) * v.other;
      film.share = share;
    }
  for (const Film& film : films_)
    for (const auto& [b, wrench] : {std::pair(film.body, &film.on_body), std::pair(film.other, &film.on_other)}) {
      Vec3::Map(wrenches_[b].force) += film.share * wrench->head<3>();
      Vec3::Map(wrenches_[b].torque) += film.share * wrench->tail<3>();
    }
}

/// Of two free bodies the first one's places count.
bool Seepage::counted(const Face& face, std::uint32_t other) const {
  return other < face.body && std::ranges::any_of(faces_, [&](const Face& f) { return f.body == other; });
}

/// Which places of a body another solid lies against; false: none, or there is no water that could get there.
bool Seepage::cover(Face& face, std::span<const exchange::BodyState> states, const FindWet& wet) const {
  const std::uint32_t own = face.body;
  const double wide = kWide * spacing_;
  struct Near {
    std::uint32_t body;
    Eigen::Matrix3d turn;  // from the frame of the body at hand to its own: turn * local + shift
    Vec3 shift;
    const Box3* box;  // around it
  };
  const Eigen::Matrix3d turn = rotation_of(states[own]).toRotationMatrix();
  std::vector<Near> near;
  for (std::uint32_t b = 0; b < states.size(); ++b) {
    const double distance = (Vec3::Map(states[b].position) - Vec3::Map(states[own].position)).norm();
    if (b == own || !(distance < reach_[b] + reach_[own] + wide)) continue;
    const Eigen::Matrix3d to_local = rotation_of(states[b]).toRotationMatrix().transpose();
    const Vec3 apart = Vec3::Map(states[own].position) - Vec3::Map(states[b].position);
    near.push_back({b, to_local * turn, to_local * apart, &bounds_[b]});
  }
  if (near.empty() ||
      std::ranges::none_of(face.places, [&](const Place& place) { return wet(place.sample).has_value(); }))
    return false;
  face.covered.assign(face.places.size(), {});
  bool any = false;
  for (std::size_t i = 0; i < face.places.size(); ++i) {
    Covered& c = face.covered[i];
    const std::uint32_t s = face.places[i].sample;
    const Vec3 place = samples_.local[s].cast<double>();
    double least = wide;
    const Near* nearest = nullptr;
    for (const Near& other : near) {
      const Vec3 local = other.turn * place + other.shift;
      const double away = least + samples_.depth[s];
      if ((local.array() < other.box->min.array() - away || local.array() > other.box->max.array() + away).any())
        continue;
      const double gap = bodies_[other.body].solid.distance(local) - samples_.depth[s];
      if (gap < least) least = gap, nearest = &other;
    }
    c.gap = least;
    c.share = std::clamp((kWide - least / spacing_) / (kWide - kNarrow), 0.0, 1.0);
    if (nearest) c.other = nearest->body;
    if (!(c.share > 0)) continue;
    // Towards the other solid, not along the sample's own normal: a sample at an edge stands for both faces.
    const Vec3 normal = bodies_[c.other].solid.normal(nearest->turn * place + nearest->shift);
    c.normal = -(turn * (nearest->turn.transpose() * normal));
    c.point = Vec3::Map(states[own].position) + turn * place + samples_.depth[s] * c.normal;
    any = true;
  }
  return any;
}

/// Head of the covered places that are not wet themselves, from those that are, as far as they hang together: the
/// graph's Laplacian of it is zero.
void Seepage::spread(Face& face) const {
  std::vector<Covered>& covered = face.covered;
  std::vector<std::uint32_t> open, number(covered.size(), 0);
  for (std::uint32_t i = 0; i < covered.size(); ++i)
    if (covered[i].known) open.push_back(i);
  std::vector<std::uint32_t> unknown;
  while (!open.empty()) {
    const std::uint32_t i = open.back();
    open.pop_back();
    for (const std::uint32_t j : face.places[i].neighbours) {
      Covered& c = covered[j];
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
      if (!covered[j].reached) continue;
      entries.emplace_back(row, row, 1.0);
      if (covered[j].known)
        right[row] += covered[j].head;
      else
        entries.emplace_back(row, static_cast<Eigen::Index>(number[j]), -1.0);
    }
  }
  Eigen::SparseMatrix<double> laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(laplacian);
  const Eigen::VectorXd head = factor.solve(right);
  for (Eigen::Index row = 0; row < n; ++row) covered[unknown[static_cast<std::size_t>(row)]].head = head[row];
}

std::size_t Seepage::memory() const {
  std::size_t sum = 0;
  for (const Face& face : faces_) {
    sum += face.covered.capacity() * sizeof(Covered);
    for (const Place& place : face.places) sum += sizeof(Place) + place.neighbours.capacity() * sizeof(std::uint32_t);
  }
  return sum;
}

}  // namespace ballast::fluid
