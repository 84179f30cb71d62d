// ODE geometry. Geoms hang on no ODE body: poses come from the body set, so that no history can enter a contact.
#include "rigid_client/ode_shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace ballast::rigid {

namespace {

using exchange::ShapeRecord;
using exchange::ShapeType;

constexpr int kMostPoints = 8;  // contacts kept per pair of shapes: a face against a face has at most eight corners
constexpr int kMostMeshPoints = 64;  // asked for where a mesh takes part, then thinned
constexpr double kFarAway = 1e9;     // m
constexpr double kSamePoint = 1e-9;  // relative to length_scale
constexpr double kDepthSlop = 1e-3;  // of length_scale: ten times as deep as resting contacts are

void start_ode() {
  static const int started = dInitODE2(0);
  thread_local const int allocated = dAllocateODEDataForThread(dAllocateMaskAll);
  (void)allocated;
  (void)started;
}

// In the plane x-z a round shape whose axis is y is a disc. As a sphere at y = 0 it has the disc's exact contacts, with
// one point instead of several; ODE's cylinder against cylinder returns a single point at one end.
bool is_disc(const ShapeRecord& r, const Quat& q) {
  const bool round = r.type == ShapeType::kCylinder || r.type == ShapeType::kCapsule;
  return r.type == ShapeType::kSphere || (round && std::abs((q * Vec3::UnitZ()).y()) > 1 - 1e-9);
}

dGeomID make_geom(const ShapeRecord& r, bool disc) {
  if (disc) return dCreateSphere(nullptr, r.radius);
  switch (r.type) {
    case ShapeType::kBox:
      return dCreateBox(nullptr, r.size[0], r.size[1], r.size[2]);
    case ShapeType::kSphere:
      return dCreateSphere(nullptr, r.radius);
    case ShapeType::kCylinder:
      return dCreateCylinder(nullptr, r.radius, r.length);
    case ShapeType::kCapsule:
      return dCreateCapsule(nullptr, r.radius, r.length);
    case ShapeType::kPlane:
      return dCreatePlane(nullptr, 0, 0, 1, 0);
    case ShapeType::kMesh:
      break;
  }
  return nullptr;
}

double least_half_extent(const ShapeRecord& r, const exchange::ManifestView& manifest, bool planar) {
  switch (r.type) {
    case ShapeType::kBox:
      return 0.5 * std::min({r.size[0], planar ? r.size[0] : r.size[1], r.size[2]});
    case ShapeType::kSphere:
    case ShapeType::kCapsule:
      return r.radius;
    case ShapeType::kCylinder:
      return planar ? r.radius : std::min(r.radius, 0.5 * r.length);
    case ShapeType::kPlane:
      return HUGE_VAL;
    case ShapeType::kMesh:
      break;
  }
  Vec3 low = Vec3::Constant(HUGE_VAL), high = -low;
  for (std::uint32_t v = 0; v < r.vertex_count; ++v) {
    const Vec3 point = Vec3::Map(&manifest.vertices[3 * (r.first_vertex + v)]);
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  if (planar) high.y() = HUGE_VAL;
  return 0.5 * (high - low).minCoeff();
}

// Keeps the deepest point and then, again and again, the one farthest from those kept: the outline of the patch.
void thin(std::vector<ContactPoint>& points) {
  if (points.size() <= kMostPoints) return;
  const auto deepest =
      std::max_element(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; });
  std::iter_swap(points.begin(), deepest);
  for (std::size_t kept = 1; kept < kMostPoints; ++kept) {
    std::size_t farthest = kept;
    double most = -1;
    for (std::size_t i = kept; i < points.size(); ++i) {
      double nearest = HUGE_VAL;
      for (std::size_t k = 0; k < kept; ++k) {
        nearest = std::min(nearest, (points[i].position - points[k].position).squaredNorm());
      }
      if (nearest > most) most = nearest, farthest = i;
    }
    std::swap(points[kept], points[farthest]);
  }
  points.resize(kMostPoints);
}

Status bad_shape(const ShapeRecord& r, const exchange::ManifestView& manifest, const char* what) {
  return Error{fmt::format("body '{}': {}", manifest.bodies[r.body].name, what), "correct the shape in the manifest",
               "", kBadInput};
}

Status check_shape(const ShapeRecord& r, const exchange::ManifestView& manifest) {
  const bool round = r.type == ShapeType::kSphere || r.type == ShapeType::kCylinder || r.type == ShapeType::kCapsule;
  if (r.type == ShapeType::kBox && !(r.size[0] > 0 && r.size[1] > 0 && r.size[2] > 0)) {
    return bad_shape(r, manifest, "a box needs three positive edges");
  }
  if (round && !(r.radius > 0)) return bad_shape(r, manifest, "a round shape needs a positive radius");
  if (r.type == ShapeType::kCylinder && !(r.length > 0))
    return bad_shape(r, manifest, "a cylinder needs a positive length");
  if (r.type == ShapeType::kPlane && manifest.bodies[r.body].motion == exchange::BodyMotion::kDynamic) {
    return bad_shape(r, manifest, "a plane is infinite and cannot be dynamic");
  }
  if (r.type == ShapeType::kMesh && (r.vertex_count < 3 || r.triangle_count < 1))
    return bad_shape(r, manifest, "an empty mesh");
  return ok();
}

}  // namespace

OdeShapes::OdeShapes() { start_ode(); }
OdeShapes::~OdeShapes() { clear(); }

void OdeShapes::clear() {
  for (const auto& part : parts_) {
    dGeomDestroy(part->geom);
    if (part->mesh) dGeomTriMeshDataDestroy(part->mesh);
  }
  parts_.clear();
  if (space_) dSpaceDestroy(space_);
  if (cap_) dGeomDestroy(cap_);
  space_ = nullptr;
  cap_ = nullptr;
}

Status OdeShapes::load(const exchange::ManifestView& manifest) {
  clear();
  // Not the hash space: ODE 0.16.2's loses pairs of neighbours of very different size, and bodies pass through walls.
  space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XZY);
  cap_ = dCreateSphere(nullptr, 1);
  dSpaceSetCleanup(space_, 0);
  planar_ = manifest.world->dimension == 2;
  half_extents_.assign(manifest.bodies.size(), 0);
  moves_.clear();
  for (const auto& body : manifest.bodies) moves_.push_back(body.motion == exchange::BodyMotion::kDynamic);
  joined_.clear();
  for (const auto& joint : manifest.joints) {
    const auto [low, high] = std::minmax(joint.parent, joint.child);
    if (low >= 0) joined_.emplace_back(low, high);
  }
  std::sort(joined_.begin(), joined_.end());
  for (const ShapeRecord& record : manifest.shapes) {
    if (auto fine = add(record, manifest); !fine) return fine;
  }
  make_surfaces();
  return ok();
}

void OdeShapes::make_surfaces() {
  const auto is_mesh = [](const auto& part) { return part->mesh != nullptr; };
  if (std::count_if(parts_.begin(), parts_.end(), is_mesh) < 2) return;
  for (const auto& part : parts_) {
    if (!is_mesh(part)) continue;
    TriangleMesh mesh;
    for (std::size_t i = 0; i < part->vertices.size(); i += 3) mesh.vertices.push_back(Vec3::Map(&part->vertices[i]));
    for (std::size_t i = 0; i < part->triangles.size(); i += 3) {
      mesh.triangles.push_back({part->triangles[i], part->triangles[i + 1], part->triangles[i + 2]});
    }
    part->surface = std::make_unique<MeshSurface>(std::move(mesh));
  }
}

Status OdeShapes::add(const ShapeRecord& record, const exchange::ManifestView& manifest) {
  if (record.body >= manifest.bodies.size()) {
    return Error{fmt::format("a shape belongs to body {}, but there are only {}", record.body, manifest.bodies.size()),
                 "correct the manifest", "", kBadInput};
  }
  if (auto fine = check_shape(record, manifest); !fine) return fine;
  auto part = std::make_unique<Part>();
  part->body = record.body;
  part->position = Vec3::Map(record.position);
  const double* q = record.orientation;
  part->orientation = Quat(q[0], q[1], q[2], q[3]).normalized();
  part->normal = Vec3::Map(record.normal);
  if (record.type == ShapeType::kMesh) {
    add_mesh(*part, record, manifest);
  } else {
    const double* b = manifest.bodies[record.body].orientation;
    part->geom = make_geom(record, planar_ && is_disc(record, Quat(b[0], b[1], b[2], b[3]) * part->orientation));
  }
  dGeomSetData(part->geom, reinterpret_cast<void*>(parts_.size()));
  dSpaceAdd(space_, part->geom);
  const double half = least_half_extent(record, manifest, planar_);
  double& least = half_extents_[record.body];
  least = least == 0 ? half : std::min(least, half);
  parts_.push_back(std::move(part));
  return ok();
}

void OdeShapes::add_mesh(Part& part, const ShapeRecord& record, const exchange::ManifestView& manifest) {
  const auto vertices =
      manifest.vertices.subspan(3 * std::size_t{record.first_vertex}, 3 * std::size_t{record.vertex_count});
  const auto triangles =
      manifest.triangles.subspan(3 * std::size_t{record.first_triangle}, 3 * std::size_t{record.triangle_count});
  part.vertices.assign(vertices.begin(), vertices.end());
  part.triangles.assign(triangles.begin(), triangles.end());
  part.mesh = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(part.mesh, part.vertices.data(), 3 * sizeof(double),
                              static_cast<int>(record.vertex_count), part.triangles.data(),
                              static_cast<int>(part.triangles.size()), 3 * sizeof(dTriIndex));
  part.geom = dCreateTriMesh(nullptr, part.mesh, nullptr, nullptr, nullptr);
}

void OdeShapes::place(const BodySet& bodies) {
  for (const auto& part : parts_) {
    const Motion& motion = bodies.now[part->body];
    Vec3 x = motion.position + motion.orientation * part->position;
    if (planar_) x.y() = 0;
    if (dGeomGetClass(part->geom) == dPlaneClass) {
      const Vec3 n = (motion.orientation * (part->orientation * part->normal)).normalized();
      dGeomPlaneSetParams(part->geom, n.x(), n.y(), n.z(), n.dot(x));
      continue;
    }
    const Quat q = motion.orientation * part->orientation;
    const dQuaternion wxyz = {q.w(), q.x(), q.y(), q.z()};
    dGeomSetPosition(part->geom, x.x(), x.y(), x.z());
    dGeomSetQuaternion(part->geom, wxyz);
  }
}

void OdeShapes::note_pair(void* self, dGeomID a, dGeomID b) {
  auto& shapes = *static_cast<OdeShapes*>(self);
  const auto i = reinterpret_cast<std::size_t>(dGeomGetData(a)), j = reinterpret_cast<std::size_t>(dGeomGetData(b));
  const std::size_t body_i = shapes.parts_[i]->body, body_j = shapes.parts_[j]->body;
  if (body_i == body_j || (!shapes.moves_[body_i] && !shapes.moves_[body_j])) return;
  const std::pair<std::size_t, std::size_t> key = std::minmax(body_i, body_j);
  if (std::binary_search(shapes.joined_.begin(), shapes.joined_.end(), key)) return;
  shapes.pairs_.emplace_back(std::min(i, j), std::max(i, j));
}

void OdeShapes::collide(const BodySet& bodies, std::vector<ContactPoint>& out) {
  out.clear();
  // ODE ends the process on coordinates that it cannot hash; the body set names such a body at the end of the step.
  const auto lost = [](const Motion& m) {
    return !(m.position.norm() < kFarAway) || !m.orientation.coeffs().allFinite();
  };
  if (std::any_of(bodies.now.begin(), bodies.now.end(), lost)) return;
  place(bodies);
  pairs_.clear();
  dSpaceCollide(space_, this, note_pair);
  // The space's own order depends on what was moved before; the parts' order is the manifest's.
  std::sort(pairs_.begin(), pairs_.end());
  for (const auto& [a, b] : pairs_) touch(a, b, bodies, out);
}

int OdeShapes::collide_caps(dGeomID capsule, dGeomID other, bool first, dContactGeom* out) {
  dReal radius = 0, length = 0;
  dGeomCapsuleGetParams(capsule, &radius, &length);
  dGeomSphereSetRadius(cap_, radius);
  const dReal *x = dGeomGetPosition(capsule), *r = dGeomGetRotation(capsule);
  int n = 0;
  for (const double end : {-0.5 * length, 0.5 * length}) {
    dGeomSetPosition(cap_, x[0] + end * r[2], x[1] + end * r[6], x[2] + end * r[10]);
    n += first ? dCollide(cap_, other, 1, out + n, sizeof(dContactGeom))
               : dCollide(other, cap_, 1, out + n, sizeof(dContactGeom));
  }
  return n;
}

void OdeShapes::collide_geoms(const Part& a, const Part& b) {
  std::array<dContactGeom, kMostMeshPoints + 2> geoms;
  const int most = a.mesh || b.mesh ? kMostMeshPoints : kMostPoints;
  int n = dCollide(a.geom, b.geom, most, geoms.data(), sizeof(dContactGeom));
  const bool a_capsule = dGeomGetClass(a.geom) == dCapsuleClass, b_capsule = dGeomGetClass(b.geom) == dCapsuleClass;
  if (n > 0 && a_capsule && !b_capsule) n += collide_caps(a.geom, b.geom, true, geoms.data() + n);
  if (n > 0 && b_capsule && !a_capsule) n += collide_caps(b.geom, a.geom, false, geoms.data() + n);
  for (int i = 0; i < n; ++i) {
    const dContactGeom& g = geoms[static_cast<std::size_t>(i)];
    found_.push_back({Vec3::Map(g.pos), Vec3::Map(g.normal), g.depth});
  }
}

void OdeShapes::collide_meshes(const Part& a, const Part& b, const BodySet& bodies) {
  const auto placed = [&](const Part& part) {
    const Motion& motion = bodies.now[part.body];
    Vec3 x = motion.position + motion.orientation * part.position;
    if (planar_) x.y() = 0;
    return PlacedSurface{part.surface.get(), x, motion.orientation * part.orientation};
  };
  // A body moves at most a quarter of its extent between two searches; two do it together.
  const double reach = std::max(moves_[a.body] ? half_extents_[a.body] : 0, moves_[b.body] ? half_extents_[b.body] : 0);
  find_contacts(placed(a), placed(b), reach, kDepthSlop * bodies.world.length_scale, found_);
}

void OdeShapes::touch(std::size_t a, std::size_t b, const BodySet& bodies, std::vector<ContactPoint>& out) {
  const Part &first = *parts_[a], &second = *parts_[b];
  found_.clear();
  const bool meshes = first.surface && second.surface;
  if (meshes) {
    collide_meshes(first, second, bodies);
  } else {
    collide_geoms(first, second);
  }
  const bool swap = !moves_[first.body];
  const auto &one = bodies.records[first.body], &two = bodies.records[second.body];
  ContactPoint c{};
  c.body = swap ? second.body : first.body;
  c.other = swap ? first.body : second.body;
  c.friction = std::sqrt(one.friction * two.friction);
  c.restitution = std::max(one.restitution, two.restitution);
  std::vector<ContactPoint>& points = points_;
  points.clear();
  for (const SurfaceContact& at : found_) {
    c.position = at.position;
    c.normal = swap ? Vec3(-at.normal) : at.normal;
    c.depth = at.depth;
    if (planar_) {  // the section at y = 0 stands for the whole depth: front and back points fall together
      c.position.y() = 0;
      c.normal.y() = 0;
      if (c.normal.norm() < 0.5) continue;
      c.normal.normalize();
    }
    const double same = kSamePoint * bodies.world.length_scale;
    const bool twin = std::any_of(points.begin(), points.end(), [&](const ContactPoint& other) {
      return (other.position - c.position).norm() <= same && other.normal.dot(c.normal) > 1 - 1e-6;
    });
    if (c.depth > 0 && !twin) points.push_back(c);
  }
  if (!meshes) thin(points);
  out.insert(out.end(), points.begin(), points.end());
}

}  // namespace ballast::rigid
