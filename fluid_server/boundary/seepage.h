// Water under a body that stands on another: no particle fits into the gap, but water does, and its pressure lifts.
// Where a face of a free body lies within a spacing of another solid, the pressure of the film between them is that of
// the fluid at the rim, with its head spread over the face as by seepage through an even gap (Laplace's equation).
// Without it a light body on the floor is pressed down by all the water above and never rises.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/bodies.h"
#include "common/scene/scene.h"
#include "fluid_server/boundary/samples.h"
#include "fluid_server/kernel.h"

namespace ballast::fluid {

class Seepage {
 public:
  /// `bodies` and `samples` must outlive this. `gravity` in m/s^2, `density` of the fluid in kg/m^3.
  Seepage(const Scene& scene, const Samples& samples, std::span<const Body> bodies, const Kernel& kernel,
          const Vec3& gravity, double density, int threads = 1);

  /// What the fluid does to a wet sample.
  struct Wet {
    double pressure;   ///< that it bears, Pa
    double seen;       ///< of the particles around it, Pa; the same but for thin sheets
    Vec3 area;         ///< force per unit of pressure, m^2
    double share = 1;  ///< by which what it extrapolates is scaled
  };
  /// Of a sample, by its index; nothing if it is dry. Called from all threads.
  using FindWet = std::function<std::optional<Wet>(std::uint32_t)>;
  /// Finds the films and their pressure. Where particles press on a place already, no film does.
  void solve(std::span<const exchange::BodyState> states, const FindWet& wet);

  void set_gravity(const Vec3& gravity) { weight_ = density_ * gravity; }
  bool empty() const { return films_.empty(); }
  /// Wrenches of the films on all bodies, action equal to reaction, about the centres of mass. A film can open its gap
  /// no faster than water flows in from the rim, driven by its pressure (Bernoulli): v = h / l sqrt(2 p / rho), h the
  /// gap, l the way; its pressure falls until it does not. `without` are the bodies' accelerations without films.
  void press(std::span<const exchange::BodyState> states, std::span<const Eigen::Matrix<double, 6, 1>> without,
             double dt);

  std::span<const exchange::Wrench> wrenches() const { return wrenches_; }
  /// Back to the wrenches of an earlier moment.
  void put_back(std::span<const exchange::Wrench> wrenches) { wrenches_.assign(wrenches.begin(), wrenches.end()); }
  template <class A>
  void state(A& a) {
    a("wrenches", wrenches_);
  }
  std::size_t memory() const;

 private:
  struct Place {  // of the first layer of a free body
    std::uint32_t sample;
    double area;
    std::vector<std::uint32_t> neighbours;  // places of the same body
  };
  struct Covered {
    std::uint32_t other = 0;  // the solid that lies against it
    double gap = 0;
    double share = 0;  // 1: a narrow gap, 0: none or one that particles fit into
    double head = 0;
    double bears = 0;  // share of its area that the film bears
    bool known = false, reached = false, dry = false;
    bool trapped = false;                              // particles that cannot get out press on it
    double pressed = 0;                                // share of its area that they press on ..
    double inside = 0;                                 // .. with this pressure, Pa
    double lacks = 0;                                  // share of the film's pressure that theirs is short of
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();  // of the body's surface, world
  };
  struct Face {
    std::uint32_t body;
    std::vector<Place> places;
    // of the step at hand
    bool has_films = false;
    std::vector<Covered> covered;  // by place
  };
  struct Film {  // between a free body and one side of another solid
    std::uint32_t body = 0, other = 0;
    double force = 0, area = 0, gap = 0;               // sums; the gap weighted by area
    double share = 0;                                  // of the force, so that water can follow
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();  // sums weighted by force
    Vec3 face = Vec3::Zero();                          // towards the other, m^2
    Vector6 on_body = Vector6::Zero(), on_other = Vector6::Zero();
    void scale(double by);
  };
  Film& film(std::uint32_t body, std::uint32_t other, const Vec3& normal);
  struct Column {  // of a lattice behind the other solid's surface, along and across the face
    int along, across;
    double weight;  // share of the area of a place that it bears
  };
  bool cover(Face& face, std::span<const exchange::BodyState> states, const FindWet& wet) const;
  double bearing(const Covered& covered, const Quat& rotation, const exchange::BodyState& other) const;
  void spread(Face& face) const;
  void hold_trapped(Covered& covered, const exchange::BodyState& state) const;
  bool counted(const Face& face, std::uint32_t other) const;
  struct Closed {  // a body with water or films on every side
    explicit Closed(std::uint32_t of) : body(of) {}
    std::uint32_t body;
    Vec3 open = Vec3::Zero();  // force per unit of pressure that its samples leave open, m^2
  };
  double column(const Vec3& point, const exchange::BodyState& state) const;
  void read_rims(Face& face, const exchange::BodyState& state, const FindWet& wet) const;
  void bear(const Face& face, std::span<const exchange::BodyState> states);
  void note_closed(const Face& face, const FindWet& wet);
  void close();

  std::span<const Body> bodies_;
  const Samples& samples_;
  double spacing_;
  int threads_;
  double density_;
  Vec3 weight_;                // density times gravity
  std::vector<Box3> bounds_;   // of each body in its frame; infinite for planes
  std::vector<double> reach_;  // of each body's surface from its centre; infinite for planes
  std::vector<Column> columns_;
  std::vector<Face> faces_;
  std::vector<Film> films_;
  std::vector<Closed> closed_;
  std::vector<exchange::Wrench> wrenches_;
};

}  // namespace ballast::fluid
