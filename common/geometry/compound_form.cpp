// Unions of posed parts. Parts may touch or overlap; what overlaps counts once.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/form.h"
#include "common/geometry/general_samples.h"
#include "common/geometry/tessellate.h"

namespace ballast::geometry {
namespace {

constexpr int kOverlapCells = 64;  // per axis, over the common bounds of two parts: volume to about 1e-3 of the overlap

struct Piece {
  FormPtr form;
  Pose pose;
  Box3 bounds;  // in the compound's frame
  Vec3 to_part(const Vec3& p) const { return pose.rotation.conjugate() * (p - pose.position); }
  double distance(const Vec3& p) const { return form->distance(to_part(p)); }
  Vec3 normal(const Vec3& p) const { return pose.rotation * form->normal(to_part(p)); }
};

Box3 turned(const Box3& box, const Pose& pose) {
  const Vec3 half = pose.rotation.toRotationMatrix().cwiseAbs() * (0.5 * (box.max - box.min));
  const Vec3 centre = pose.position + pose.rotation * (0.5 * (box.min + box.max));
  return {centre - half, centre + half};
}

// Volume, first and second moments about the origin: they add up.
struct Moments {
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  void add(double v, const Vec3& x) {
    volume += v;
    first += v * x;
    second += v * x * x.transpose();
  }
};

class CompoundForm : public Form {
 public:
  CompoundForm(std::vector<Piece> pieces, int dimension) : pieces_(std::move(pieces)), flat_(dimension == 2) {
    bounds_ = pieces_.front().bounds;
    for (const Piece& piece : pieces_) {
      bounds_.min = bounds_.min.cwiseMin(piece.bounds.min);
      bounds_.max = bounds_.max.cwiseMax(piece.bounds.max);
      container_ = container_ || piece.form->is_container();
    }
    integrate();
  }
  MassProperties mass_properties() const override { return mass_; }
  double distance(const Vec3& p) const override {
    double nearest = kInf;
    for (const Piece& piece : pieces_) nearest = std::min(nearest, piece.distance(p));
    return nearest;
  }
  Vec3 normal(const Vec3& p) const override {
    const auto nearest = std::min_element(
        pieces_.begin(), pieces_.end(), [&](const Piece& a, const Piece& b) { return a.distance(p) < b.distance(p); });
    return nearest->normal(p);
  }
  Box3 bounds() const override { return bounds_; }
  bool is_container() const override { return container_; }
  double room_distance(const Vec3& p) const override {
    double room = kInf, solid = kInf;
    for (const Piece& piece : pieces_) {
      if (piece.form->is_container()) {
        room = std::min(room, piece.form->room_distance(piece.to_part(p)));
      } else {
        solid = std::min(solid, piece.distance(p));
      }
    }
    return std::max(room, -solid);
  }
  std::vector<SurfaceSample> samples(const SampleRequest& request) const override {
    if (overlapping_) {
      return general_samples(*this, flat_ ? 2 : 3, request, [this](const Vec3& c, double h) { return share(c, h); });
    }
    std::vector<SurfaceSample> samples;
    for (const Piece& piece : pieces_) {
      const Pose back{-(piece.pose.rotation.conjugate() * piece.pose.position), piece.pose.rotation.conjugate()};
      const SampleRequest part{request.spacing, request.depth, turned(request.window, back)};
      for (SurfaceSample s : piece.form->samples(part)) {
        s.position = piece.pose.position + piece.pose.rotation * s.position;
        samples.push_back(s);
      }
    }
    return samples;
  }
  TriangleMesh surface() const override {
    TriangleMesh mesh;
    for (const Piece& piece : pieces_) {
      TriangleMesh part = piece.form->surface();
      for (Vec3& v : part.vertices) v = piece.pose.position + piece.pose.rotation * v;
      append(mesh, part);
    }
    return mesh;
  }
  std::vector<SolidPiece> pieces() const override {
    std::vector<SolidPiece> all;
    for (const Piece& piece : pieces_) {
      for (SolidPiece part : piece.form->pieces()) {
        part.pose.position = piece.pose.position + piece.pose.rotation * part.pose.position;
        part.pose.rotation = piece.pose.rotation * part.pose.rotation;
        all.push_back(std::move(part));
      }
    }
    return all;
  }

 private:
  // Sum over the parts, less what lies in several of them: a point in m parts is met by m (m - 1) / 2 pairs and counted
  // m - 1 times too often, so each pair takes away 2 / m of it.
  void integrate() {
    Moments sum;
    for (const Piece& piece : pieces_) add_part(piece, sum);
    const double total = sum.volume;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      for (std::size_t j = i + 1; j < pieces_.size(); ++j) subtract_overlap(i, j, sum);
    }
    overlapping_ = total - sum.volume > 1e-9 * total;
    mass_.volume = sum.volume;
    mass_.centre = sum.first / sum.volume;
    const Eigen::Matrix3d about = sum.second - sum.volume * mass_.centre * mass_.centre.transpose();
    mass_.inertia = about.trace() * Eigen::Matrix3d::Identity() - about;
  }
  static void add_part(const Piece& piece, Moments& sum) {
    const MassProperties part = piece.form->mass_properties();
    const Eigen::Matrix3d r = piece.pose.rotation.toRotationMatrix();
    sum.add(part.volume, piece.pose.position + r * part.centre);
    // From inertia back to second moments: J = trace(S) 1 - S, trace(J) = 2 trace(S).
    const Eigen::Matrix3d about = 0.5 * part.inertia.trace() * Eigen::Matrix3d::Identity() - part.inertia;
    sum.second += r * about * r.transpose();
  }
  void subtract_overlap(std::size_t i, std::size_t j, Moments& sum) const {
    const Vec3 lo = pieces_[i].bounds.min.cwiseMax(pieces_[j].bounds.min);
    const Vec3 size = pieces_[i].bounds.max.cwiseMin(pieces_[j].bounds.max) - lo;
    if (size.minCoeff() <= 1e-9 * (bounds_.max - bounds_.min).maxCoeff()) return;
    const Vec3 cell = size / kOverlapCells;
    const int layers = flat_ ? 1 : kOverlapCells;
    const double volume = cell.x() * cell.z() * (flat_ ? 1 : cell.y());
    // Only what is clearly inside both counts: parts that touch along a slanted face do not overlap.
    const double touching = -1e-9 * (bounds_.max - bounds_.min).maxCoeff();
    for (int z = 0; z < kOverlapCells; ++z) {
      for (int y = 0; y < layers; ++y) {
        for (int x = 0; x < kOverlapCells; ++x) {
          Vec3 p = lo + cell.cwiseProduct(Vec3(x + 0.5, y + 0.5, z + 0.5));
          if (flat_) p.y() = 0;
          if (pieces_[i].distance(p) >= touching || pieces_[j].distance(p) >= touching) continue;
          const auto in = std::count_if(pieces_.begin(), pieces_.end(),
                                        [&](const Piece& piece) { return piece.distance(p) < touching; });
          sum.add(-volume * 2 / static_cast<double>(in), p);
        }
      }
    }
  }
  // Where two parts meet face to face their shares of a cell add up; where their faces lie side by side they do not.
  double share(const Vec3& centre, double edge) const {
    double sum = 0;
    Vec3 normal = Vec3::Zero();
    for (const Piece& piece : pieces_) {
      const double f = std::clamp(0.5 - piece.distance(centre) / edge, 0.0, 1.0);
      if (f >= 1) return 1;
      if (f <= 0) continue;
      const Vec3 n = piece.normal(centre);
      sum = sum > 0 && n.dot(normal) < 0 ? std::min(1.0, sum + f) : std::max(sum, f);
      normal = n;
    }
    return sum;
  }

  std::vector<Piece> pieces_;
  bool flat_, container_ = false, overlapping_ = false;
  Box3 bounds_;
  MassProperties mass_;
};

}  // namespace

Result<FormPtr> make_compound(const std::vector<Part>& parts, int dimension, double spacing) {
  if (parts.empty()) return Error{"a compound without parts", "give it at least one part", "", kBadInput};
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto refuse = [&](const Error& e) {
      return Error{fmt::format("part {} of the compound: {}", i + 1, e.what), e.cure, e.where, e.exit_code};
    };
    const Quat& q = parts[i].pose.rotation;
    if (parts[i].shape.kind == ShapeKind::kPlane) {
      return refuse({"a plane is infinite", "make it a model of its own, or use a box", "", kBadInput});
    }
    if (dimension == 2 && std::hypot(q.x(), q.z()) > 1e-9) {
      return refuse({"it is turned out of the x-z plane", "in dimension 2 rotate about y only", "", kBadInput});
    }
    Result<FormPtr> form = make_form(parts[i].shape, dimension, spacing);
    if (!form) return refuse(form.error());
    Pose pose{parts[i].pose.position, q.normalized()};
    if (dimension == 2) pose.position.y() = 0;
    const Box3 bounds = turned((*form)->bounds(), pose);
    pieces.push_back({std::move(*form), pose, bounds});
  }
  return FormPtr(std::make_unique<CompoundForm>(std::move(pieces), dimension));
}

}  // namespace ballast::geometry
