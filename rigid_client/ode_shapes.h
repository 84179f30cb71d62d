// ODE geometry: shapes of the manifest, and the contacts between them at given poses, in an order that depends on
// nothing else.
#pragma once
#include <ode/ode.h>

#include <memory>
#include <utility>
#include <vector>

#include "rigid_client/body_set.h"
#include "rigid_client/mesh_contacts.h"

namespace ballast::rigid {

/// One point where a dynamic body touches another body.
struct ContactPoint {
  std::size_t body;    ///< dynamic
  std::size_t other;   ///< any
  Vec3 position;       ///< m, world
  Vec3 normal;         ///< unit, from other into body
  double depth;        ///< m, > 0
  double friction;     ///< sqrt(mu_1 mu_2): one slippery surface is enough
  double restitution;  ///< max(e_1, e_2): a superball bounces off any floor
};

class OdeShapes {
 public:
  OdeShapes();
  ~OdeShapes();
  OdeShapes(const OdeShapes&) = delete;
  OdeShapes& operator=(const OdeShapes&) = delete;

  Status load(const exchange::ManifestView& manifest);
  /// All contacts at the bodies' present poses, sorted by body and shape index.
  void collide(const BodySet& bodies, std::vector<ContactPoint>& out);
  /// Least half extent of a body's shapes, m: how far it may move at once without missing a contact. 0: no shape.
  double half_extent(std::size_t body) const { return half_extents_[body]; }

 private:
  struct Part {
    std::size_t body = 0;
    Vec3 position = Vec3::Zero();
    Quat orientation = Quat::Identity();
    Vec3 normal = Vec3::Zero();  // plane, body frame
    dGeomID geom = nullptr;
    dTriMeshDataID mesh = nullptr;
    std::vector<double> vertices;
    std::vector<dTriIndex> triangles;
    std::unique_ptr<MeshSurface> surface;  // where several bodies are meshes
  };
  Status add(const exchange::ShapeRecord& record, const exchange::ManifestView& manifest);
  void add_mesh(Part& part, const exchange::ShapeRecord& record, const exchange::ManifestView& manifest);
  void make_surfaces();
  void place(const BodySet& bodies);
  void touch(std::size_t a, std::size_t b, const BodySet& bodies, std::vector<ContactPoint>& out);
  /// Fills found_ with contacts whose normals point into the first part.
  void collide_meshes(const Part& a, const Part& b, const BodySet& bodies);
  void collide_geoms(const Part& a, const Part& b);
  /// Contacts of a capsule's two caps: ODE itself returns a single point for a capsule that lies on a face, which
  /// rocks.
  int collide_caps(dGeomID capsule, dGeomID other, bool first, dContactGeom* out);
  void clear();
  static void note_pair(void* self, dGeomID a, dGeomID b);

  bool planar_ = false;
  dSpaceID space_ = nullptr;
  dGeomID cap_ = nullptr;  ///< sphere put at a capsule's ends
  std::vector<ContactPoint> points_;
  std::vector<SurfaceContact> found_;
  std::vector<std::unique_ptr<Part>> parts_;
  std::vector<double> half_extents_;
  std::vector<bool> moves_;                                  // body is dynamic
  std::vector<std::pair<std::size_t, std::size_t>> joined_;  // pairs of bodies with a joint: no contacts, sorted
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;   // of parts, found by the space
};

}  // namespace ballast::rigid
