// Contacts between two triangle meshes. For convex bodies the features below are the faces of the Minkowski difference
// (Ericson, Real-Time Collision Detection, 9.1; Gregorius, GDC 2013), taken here near each other instead of globally:
//   vertex of one below a face of the other, if the vertex leads against the face's normal
//   two convex edges that cross, if both lead along their common normal
// Two faces on each other need nothing of their own: the corners of their common polygon are just these features.
#include "rigid_client/mesh_contacts.h"

#include <algorithm>
#include <cmath>

namespace ballast::rigid {

namespace {

constexpr std::size_t kMostOnASide = 8;    // kept per pair: a face against a face has at most eight corners
constexpr std::size_t kMostContacts = 12;  // where they have several sides
constexpr double kBorder = 1e-6;           // of the smaller extent: how far beyond the border of a face still counts
constexpr double kParallel = 0.01;         // sine of the angle below which edges do not cross: their ends are vertices
constexpr double kSame = 1e-3;             // of the smaller extent: contacts nearer than this are one
constexpr double kShallow = 0.05;          // of the smaller extent: first search
constexpr double kAlike = 0.9;             // cosine: normals that point to the same side

struct Box {
  Vec3 low, high;
};

Box bounds(const std::array<Vec3, 3>& t, double margin) {
  const Vec3 m = Vec3::Constant(margin);
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]) - m, t[0].cwiseMax(t[1]).cwiseMax(t[2]) + m};
}

// Works in the frame of b. `end_a`, `end_b`: the points that part last, on a and on b; depth and normal join them.
struct Candidate {
  Vec3 end_a, end_b, normal;
  double depth;
};

class Search {
 public:
  Search(const PlacedSurface& a, const PlacedSurface& b, double slop) : a_(*a.surface), b_(*b.surface), slop_(slop) {
    const Quat back = b.orientation.conjugate();
    turn_ = (back * a.orientation).toRotationMatrix();
    shift_ = back * (a.position - b.position);
    size_ = std::min(a_.least_extent(), b_.least_extent());
    border_ = kBorder * size_;
  }

  // Almost every contact is shallow; the deep search, which looks at many more pairs of triangles, is for overlaps at
  // the start and for fast bodies.
  void run(double reach) {
    const double first = std::min(reach, kShallow * size_);
    visit(first);
    if (first < reach && (deeper_ || (crossed_ && found_.empty()))) visit(reach);
    spread();
  }
  const std::vector<Candidate>& found() const { return found_; }

 private:
  Vec3 into_b(const Vec3& p) const { return turn_ * p + shift_; }
  Vec3 into_a(const Vec3& p) const { return turn_.transpose() * (p - shift_); }

  void visit(double reach) {
    found_.clear();
    reach_ = reach;
    // Bounds of b as a box in the frame of a.
    const Vec3 centre = into_a(0.5 * (b_.low() + b_.high()));
    const Vec3 half = turn_.transpose().cwiseAbs() * (0.5 * (b_.high() - b_.low())) + Vec3::Constant(reach);
    a_.distance().overlapping(centre - half, centre + half, faces_a_);
    for (const std::uint32_t i : faces_a_) {
      const MeshSurface::Face& s = a_.faces()[i];
      const std::array<Vec3, 3> corners{into_b(s.corners[0]), into_b(s.corners[1]), into_b(s.corners[2])};
      const Vec3 normal = turn_ * s.normal;
      const Box box = bounds(corners, reach);
      b_.distance().overlapping(box.low, box.high, faces_b_);
      for (const std::uint32_t j : faces_b_) {
        const MeshSurface::Face& t = b_.faces()[j];
        touch({corners, normal, s}, {t.corners, t.normal, t});
      }
    }
    drop_false();
  }

  struct Triangle {
    const std::array<Vec3, 3>& at;
    const Vec3& normal;
    const MeshSurface::Face& face;
  };

  static Vec3 heights(const Triangle& s, const Triangle& t) {
    const double plane = t.normal.dot(t.at[0]);
    return Vec3(t.normal.dot(s.at[0]), t.normal.dot(s.at[1]), t.normal.dot(s.at[2])) - Vec3::Constant(plane);
  }

  void touch(const Triangle& s, const Triangle& t) {
    const Vec3 over_t = heights(s, t), over_s = heights(t, s);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = s.face.vertices[k], w = t.face.vertices[k];
      if (v != MeshSurface::kNone && is_below(s.at[k], -over_t[k], t, true) &&
          a_.vertex_leads(v, -(turn_.transpose() * t.normal))) {
        found_.push_back({s.at[k], s.at[k] - over_t[k] * t.normal, t.normal, -over_t[k]});
      }
      if (w != MeshSurface::kNone && is_below(t.at[k], -over_s[k], s, false) && b_.vertex_leads(w, -s.normal)) {
        found_.push_back({t.at[k] - over_s[k] * s.normal, t.at[k], -s.normal, -over_s[k]});
      }
    }
    // Where convex edges cross, each is below both faces of the other.
    const auto is_near = [&](const Vec3& over) { return over.minCoeff() < 0 && over.maxCoeff() >= -reach_; };
    if (!is_near(over_t) || !is_near(over_s)) return;
    for (const std::uint32_t e : s.face.edges) {
      for (const std::uint32_t f : t.face.edges) {
        if (e != MeshSurface::kNone && f != MeshSurface::kNone) cross(a_.edge(e), b_.edge(f));
      }
    }
    crossed_ = crossed_ || pierces(s, over_t, t) || pierces(t, over_s, s);
  }

  // Signed distances; the surface is known to be `within`.
  double to_b(const Vec3& p, double within) const { return b_.distance().nearest(p, within + 2 * border_).distance; }
  double to_a(const Vec3& p, double within) const {
    return a_.distance().nearest(into_a(p), within + 2 * border_).distance;
  }

  bool is_over(const Vec3& p, const Triangle& t, double beyond_concave) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 edge = t.at[(k + 1) % 3] - t.at[k];
      const double beyond = t.face.concave[k] ? beyond_concave : border_;
      if (t.normal.cross(edge).dot(p - t.at[k]) < -beyond * edge.norm()) return false;
    }
    return true;
  }
  // Beyond a concave edge the solid goes on: in a corner of a room a vertex is behind both walls and above neither.
  // There the deeper contact counts, and both up to the slop.
  bool is_below(const Vec3& p, double depth, const Triangle& t, bool of_b) {
    if (depth <= 0) return false;
    const bool over = is_over(p, t, border_);
    if (depth > reach_) {
      deeper_ = deeper_ || (over && (of_b ? to_b(p, depth) : to_a(p, depth)) < -0.5 * reach_);
      return false;
    }
    const double beyond = std::max(depth, slop_);
    return over || (is_over(p, t, beyond) && (of_b ? to_b(p, beyond) : to_a(p, beyond)) <= border_);
  }
  bool pierces(const Triangle& s, const Vec3& over, const Triangle& t) const {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      if ((over[k] > 0) == (over[next] > 0)) continue;
      if (is_over(s.at[k] + over[k] / (over[k] - over[next]) * (s.at[next] - s.at[k]), t, border_)) return true;
    }
    return false;
  }

  // Nearest points of two lines (Ericson 5.1.8), kept if they lie on both edges.
  void cross(const MeshSurface::Edge& e, const MeshSurface::Edge& f) {
    const Vec3 p = into_b(a_.vertex(e.from)), q = b_.vertex(f.from), r = q - p;
    const Vec3 u = into_b(a_.vertex(e.to)) - p, v = b_.vertex(f.to) - q;
    const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), area = uu * vv - uv * uv;
    if (area < kParallel * kParallel * uu * vv) return;
    const double s = (u.dot(r) * vv - v.dot(r) * uv) / area, t = (u.dot(r) * uv - v.dot(r) * uu) / area;
    const double ds = border_ / std::sqrt(uu), dt = border_ / std::sqrt(vv);
    if (s < -ds || s > 1 + ds || t < -dt || t > 1 + dt) return;
    Vec3 normal = u.cross(v).normalized();
    if (normal.dot(f.outward) < 0) normal = -normal;
    const Vec3 on_a = p + s * u, on_b = q + t * v;
    const double depth = normal.dot(on_b - on_a);
    if (depth <= 0 || depth > reach_ || !b_.edge_leads(f, normal)) return;
    if (a_.edge_leads(e, -(turn_.transpose() * normal))) found_.push_back({on_a, on_b, normal, depth});
  }

  // Whether an end of the contact lies inside the other body, after a has been moved by `shift`.
  bool is_overlap(const Candidate& c, const Vec3& shift) const {
    const double within = c.depth + shift.norm();
    return to_b(c.end_a + shift, within) <= border_ || to_a(c.end_b - shift, within) <= border_;
  }

  // Two kinds of feature pairs are no contacts. Faces of thin walls that face away from each other are below each other
  // with nothing in between: neither end lies inside the other body. And a box that stands on another is, at its sides,
  // also behind the other's sides: there a much shallower contact is near, and parting along that one is enough (in the
  // corner of a room it is not).
  void drop_false() {
    std::stable_sort(found_.begin(), found_.end(), [](const auto& x, const auto& y) { return x.depth < y.depth; });
    std::size_t kept = 0;
    for (const Candidate& c : found_) {
      const auto settles = [&](const Candidate& other) {
        return 2 * other.depth + slop_ < c.depth && other.normal.dot(c.normal) < kAlike &&
               (other.end_a - c.end_a).norm() < 2 * c.depth && !is_overlap(c, (other.depth + slop_) * other.normal);
      };
      const bool deep = c.depth > slop_;
      if (deep && (!is_overlap(c, Vec3::Zero()) || std::any_of(found_.begin(), found_.begin() + kept, settles)))
        continue;
      found_[kept++] = c;
    }
    found_.resize(kept);
  }

  // Squared distance in position and normal: contacts of different sides are far from each other wherever they are.
  double apart(const Candidate& x, const Candidate& y) const {
    return (x.end_a - y.end_a).squaredNorm() + size_ * size_ * (x.normal - y.normal).squaredNorm();
  }

  // Keeps the deepest and then, again and again, the one farthest from those kept: the outline of the patch.
  void spread() {
    std::reverse(found_.begin(), found_.end());
    std::vector<double> gap(found_.size(), HUGE_VAL);
    const bool one_side = std::all_of(found_.begin(), found_.end(),
                                      [&](const Candidate& c) { return c.normal.dot(found_.front().normal) > kAlike; });
    const std::size_t most = std::min(found_.size(), one_side ? kMostOnASide : kMostContacts);
    std::size_t kept = std::min<std::size_t>(found_.size(), 1);
    while (kept < most) {
      std::size_t farthest = kept;
      for (std::size_t i = kept; i < found_.size(); ++i) {
        gap[i] = std::min(gap[i], apart(found_[i], found_[kept - 1]));
        if (gap[i] > gap[farthest]) farthest = i;
      }
      if (gap[farthest] < kSame * kSame * size_ * size_) break;
      std::swap(found_[kept], found_[farthest]);
      std::swap(gap[kept], gap[farthest]);
      ++kept;
    }
    found_.resize(kept);
  }

  const MeshSurface &a_, &b_;
  Mat3 turn_;   // from the frame of a to that of b
  Vec3 shift_;  // m
  double size_ = 0, border_ = 0, slop_, reach_ = 0;
  bool crossed_ = false;  // the surfaces intersect
  bool deeper_ = false;   // a vertex is deeper than the search reaches
  std::vector<Candidate> found_;
  std::vector<std::uint32_t> faces_a_, faces_b_;
};

}  // namespace

void find_contacts(const PlacedSurface& a, const PlacedSurface& b, double reach, double slop,
                   std::vector<SurfaceContact>& out) {
  Search search(a, b, slop);
  search.run(reach);
  for (const Candidate& c : search.found()) {
    out.push_back({b.orientation * Vec3(0.5 * (c.end_a + c.end_b)) + b.position, b.orientation * c.normal, c.depth});
  }
}

}  // namespace ballast::rigid
