// The POV-Ray scene: right-handed with z up (POV-Ray is left-handed: its "right" vector is mirrored for that).
#include "common/output/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "common/output/povray.h"
#include "common/output/whole_file.h"

namespace ballast::output {
namespace {

constexpr int kShades = 24;         // textures for the particles' speed
constexpr double kEdgeAngle = 0.5;  // rad between faces above which an edge is drawn
constexpr double kAspect = 1280.0 / 720.0;
constexpr double kViewAngle = 32;  // degrees, horizontal

using Text = fmt::memory_buffer;

template <class... Args>
void add(Text& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

std::string vec(const Vec3& v) { return fmt::format("<{:.5g},{:.5g},{:.5g}>", v.x(), v.y(), v.z()); }

struct Drawn {
  TriangleMesh mesh;  // world frame
  bool container = false, moving = false;
};

std::vector<Drawn> place(const Scene& scene, const std::vector<Body>& bodies, std::span<const Pose> poses) {
  std::vector<Drawn> out;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Drawn drawn{bodies[i].solid.surface(), bodies[i].solid.is_container(), scene.models[i].motion != Motion::kStatic};
    for (Vec3& v : drawn.mesh.vertices) v = poses[i].position + poses[i].rotation * v;
    out.push_back(std::move(drawn));
  }
  return out;
}

/// Everything that must be in the picture.
Eigen::AlignedBox3d extent(const std::vector<Drawn>& drawn, const ParticleFrame& particles) {
  Eigen::AlignedBox3d box;
  for (const Drawn& d : drawn) {
    for (const Vec3& v : d.mesh.vertices) box.extend(v);
  }
  // Single particles far off (spray that left the tank) must not shrink the rest: the inner 99.8 % count.
  const std::size_t count = particles.position.size() / 3;
  if (count > 0) {
    std::vector<float> axis(count);
    Vec3 low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t i = 0; i < count; ++i) axis[i] = particles.position[3 * i + k];
      const std::size_t cut = count / 1000;
      std::ranges::nth_element(axis, axis.begin() + static_cast<std::ptrdiff_t>(cut));
      low[static_cast<int>(k)] = axis[cut];
      std::ranges::nth_element(axis, axis.begin() + static_cast<std::ptrdiff_t>(count - 1 - cut));
      high[static_cast<int>(k)] = axis[count - 1 - cut];
    }
    box.extend(low).extend(high);
  }
  if (box.isEmpty()) box.extend(Vec3(-1, -1, -1)).extend(Vec3(1, 1, 1));
  return box;
}

void add_camera(Text& text, const Scene& scene, const Eigen::AlignedBox3d& box) {
  const Vec3 centre = box.center(), size = box.sizes();
  if (scene.world.dimension == 2) {
    const double width = 1.06 * std::max(size.x(), kAspect * size.z());
    const Vec3 eye(centre.x(), box.min().y() - 10 * width, centre.z());
    add(text, "camera {{ orthographic location {} sky z up {:.6g}*y right {:.6g}*x look_at {} }}\n", vec(eye),
        width / kAspect, -width, vec(centre));
    add(text, "light_source {{ {} rgb 1 parallel point_at {} shadowless }}\n", vec(eye + Vec3(-width, 0, width)),
        vec(centre));
    return;
  }
  Vec3 eye = scene.output.camera;
  if (eye.isZero()) {
    const Vec3 direction = Vec3(0.42, -1, 0.5).normalized();
    const double half = kViewAngle / 2 * std::numbers::pi / 180;
    // Distance from which every corner of the box is inside the view.
    const Vec3 right = direction.cross(Vec3::UnitZ()).normalized(), up = right.cross(direction);
    double distance = 0;
    for (int c = 0; c < 8; ++c) {
      const Vec3 corner = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c)) - centre;
      const double reach = std::max(std::abs(corner.dot(right)), kAspect * std::abs(corner.dot(up)));
      distance = std::max(distance, 1.03 * reach / std::tan(half) + corner.dot(direction));
    }
    eye = centre + distance * direction;
  }
  add(text, "camera {{ location {} sky z up y right -{:.6g}*x angle {} look_at {} }}\n", vec(eye), kAspect, kViewAngle,
      vec(centre));
  const double far = 4 * (eye - centre).norm();
  add(text, "light_source {{ {} rgb 0.95 }}\n", vec(centre + far * Vec3(-0.5, -0.8, 1.2)));
  add(text, "light_source {{ {} rgb 0.35 shadowless }}\n", vec(eye));
}

std::string rgb(const Vec3& colour) {
  return fmt::format("rgb <{:.3f},{:.3f},{:.3f}>", colour.x(), colour.y(), colour.z());
}

/// Warm colours for moving bodies, far apart for neighbours in the list.
Vec3 body_colour(std::size_t index) {
  static const Vec3 kWarm[] = {{0.90, 0.42, 0.16}, {0.96, 0.72, 0.22}, {0.78, 0.22, 0.18}, {0.86, 0.56, 0.36},
                               {0.98, 0.60, 0.10}, {0.66, 0.32, 0.22}, {0.93, 0.80, 0.50}};
  return kWarm[index % std::size(kWarm)];
}

void add_mesh(Text& text, const TriangleMesh& mesh, const Vec3& colour) {
  if (mesh.triangles.empty()) return;
  add(text, "mesh {{\n");
  for (const auto& t : mesh.triangles) {
    add(text, "triangle {{{},{},{}}}\n", vec(mesh.vertices[t[0]]), vec(mesh.vertices[t[1]]), vec(mesh.vertices[t[2]]));
  }
  add(text, "texture {{ pigment {{ {} }} finish {{ ambient 0.25 diffuse 0.7 specular 0.15 roughness 0.03 }} }} }}\n",
      rgb(colour));
}

Vec3 face_normal(const TriangleMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).normalized();
}

/// Sharp edges of a closed surface as thin cylinders. Vertices are matched by place: meshes may repeat them.
void add_edges(Text& text, const TriangleMesh& mesh, double radius) {
  using Key = std::array<long, 3>;
  const auto key = [&](const Vec3& v) {
    return Key{std::lround(v.x() / radius * 16), std::lround(v.y() / radius * 16), std::lround(v.z() / radius * 16)};
  };
  std::map<std::pair<Key, Key>, std::vector<std::size_t>> faces_of;
  std::map<Key, Vec3> where;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = mesh.vertices[mesh.triangles[t][k]], &b = mesh.vertices[mesh.triangles[t][(k + 1) % 3]];
      Key ka = key(a), kb = key(b);
      where[ka] = a;
      where[kb] = b;
      if (kb < ka) std::swap(ka, kb);
      faces_of[{ka, kb}].push_back(t);
    }
  }
  add(text, "union {{\n");
  for (const auto& [ends, faces] : faces_of) {
    if (faces.size() == 2 && face_normal(mesh, faces[0]).dot(face_normal(mesh, faces[1])) > std::cos(kEdgeAngle))
      continue;
    const Vec3 &a = where[ends.first], &b = where[ends.second];
    if ((a - b).norm() < radius) continue;
    add(text, "cylinder {{{},{},{:.4g}}}\n", vec(a), vec(b), radius);
  }
  add(text, "sphere {{<0,0,-1e6>,1}}\n");  // an empty union is an error in POV-Ray
  add(text, "texture {{ pigment {{ rgb 0.35 }} finish {{ ambient 0.5 diffuse 0.5 }} }} no_shadow }}\n");
}

/// The floor of a container: its faces that look up, below the middle of the container.
void add_floor(Text& text, const TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  TriangleMesh floor{mesh.vertices, {}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double height = mesh.vertices[mesh.triangles[t][0]].z();
    if (face_normal(mesh, t).z() > 0.9 && height < box.center().z()) floor.triangles.push_back(mesh.triangles[t]);
  }
  add_mesh(text, floor, Vec3(0.80, 0.80, 0.78));
}

/// Deep blue at rest over light blue to white: speed relative to the fastest 1 % of the particles.
Vec3 water_colour(double speed) {
  static const Vec3 kStops[] = {{0.05, 0.22, 0.52}, {0.12, 0.48, 0.78}, {0.45, 0.78, 0.93}, {0.97, 0.99, 1.00}};
  const double x = std::clamp(speed, 0.0, 1.0) * 3;
  const int i = std::min(2, static_cast<int>(x));
  return kStops[i] + (x - i) * (kStops[i + 1] - kStops[i]);
}

void add_particles(Text& text, const ParticleFrame& particles, double spacing, const Vec3& gravity, double height) {
  const std::size_t count = particles.position.size() / 3;
  if (count == 0) return;
  std::vector<float> speed(count, 0.0F);
  for (std::size_t i = 0; i < count && !particles.velocity.empty(); ++i) {
    speed[i] = std::hypot(particles.velocity[3 * i], particles.velocity[3 * i + 1], particles.velocity[3 * i + 2]);
  }
  std::vector<float> sorted = speed;
  const std::size_t top = count - 1 - count / 100;
  std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(top));
  // Water at rest must look at rest: the scale never falls below a tenth of a free fall over the picture's height.
  const double scale = std::max<double>({sorted[top], 0.1 * std::sqrt(2 * gravity.norm() * height), 1e-9});
  for (int s = 0; s < kShades; ++s) {
    add(text,
        "#declare W{} = texture {{ pigment {{ {} }} finish {{ ambient 0.25 diffuse 0.7 specular 0.2 roughness 0.05 }} "
        "}}\n",
        s, rgb(water_colour((s + 0.5) / kShades)));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto* p = &particles.position[3 * i];
    if (!std::isfinite(p[0] + p[1] + p[2] + speed[i])) continue;
    const int shade = std::clamp(static_cast<int>(speed[i] / scale * kShades), 0, kShades - 1);
    add(text, "sphere {{<{:.5g},{:.5g},{:.5g}>,{:.4g} texture {{W{}}}}}\n", p[0], p[1], p[2], 0.55 * spacing, shade);
  }
}

void add_planes(Text& text, const Scene& scene) {
  for (const Model& model : scene.models) {
    if (model.shape.kind != ShapeKind::kPlane) continue;
    const Vec3 normal = model.pose.rotation * model.shape.normal;
    if (normal.z() < 0.5) continue;  // walls and ceilings would hide everything
    add(text, "plane {{ {}, {:.6g} pigment {{ rgb <0.80,0.80,0.78> }} finish {{ ambient 0.25 diffuse 0.6 }} }}\n",
        vec(normal), normal.dot(model.pose.position));
  }
}

/// True for a solid so large that, drawn opaque, it would hide the rest: walls made of boxes.
bool is_wall(const Drawn& d, const Eigen::AlignedBox3d& all) {
  Eigen::AlignedBox3d box;
  for (const Vec3& v : d.mesh.vertices) box.extend(v);
  if (box.isEmpty()) return false;
  const Vec3 share = box.sizes().cwiseQuotient(all.sizes().cwiseMax(1e-9));
  return share.x() > 0.8 && share.z() > 0.5;
}

}  // namespace

Status write_pov(const std::string& path, const Scene& scene, const std::vector<Body>& bodies,
                 std::span<const Pose> poses, const ParticleFrame& particles) {
  const std::vector<Drawn> drawn = place(scene, bodies, poses);
  const Eigen::AlignedBox3d box = extent(drawn, particles);
  const double edge = 0.0012 * box.sizes().norm();
  Text text;
  add(text, "#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 }}\nbackground {{ rgb <0.90,0.93,0.96> }}\n");
  add_camera(text, scene, box);
  add_planes(text, scene);
  std::size_t moving = 0;
  for (const Drawn& d : drawn) {
    if (d.moving && !d.container) {
      add_mesh(text, d.mesh, body_colour(moving++));
    } else if (d.container || is_wall(d, box)) {
      add_edges(text, d.mesh, edge);
      if (scene.world.dimension == 3) add_floor(text, d.mesh);
    } else {
      add_mesh(text, d.mesh, Vec3(0.55, 0.55, 0.56));
    }
  }
  add_particles(text, particles, scene.world.spacing, scene.world.gravity, box.sizes().z());
  return write_whole(path, {text.data(), text.size()});
}

Status make_picture(const std::string& folder, const Scene& scene, const std::vector<Body>& bodies,
                    std::span<const Pose> poses, const ParticleFrame& particles, int threads) {
  const std::string pov = folder + "/picture.pov";
  if (Status s = write_pov(pov, scene, bodies, poses, particles); !s) return s;
  Status drawn = run_povray(pov, folder + "/picture.png", threads);
  if (drawn) std::remove(pov.c_str());
  return drawn;
}

}  // namespace ballast::output
