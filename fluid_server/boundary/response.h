// Pressure on the samples, wrenches on the bodies, and the acceleration that a free body will have: found together,
// because the pressure extrapolated onto a body's samples depends on its acceleration and a light body's acceleration
// on it.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "common/exchange/records.h"
#include "fluid_server/boundary/samples.h"
#include "fluid_server/boundary/seepage.h"
#include "fluid_server/passes/passes.h"

namespace ballast::fluid {

/// How the acceleration of a body in the extrapolation is found.
enum class Scheme {
  kInterlinked,  ///< solved with the mobility that the rigid side posted: stable for light bodies
  kStaggered,    ///< that of the last step
  kLeftOut,      ///< none, where an implicit solve finds the pressure that lacks then
};

/// Whether the pressure of films between solids follows the samples' (seepage.h), or stays as it was found last: while
/// the fluid has none.
enum class Films { kFollow, kStay };

class Response {
 public:
  /// `buoyancy`: a force per body beside that of the samples, N, through the centre of mass (numerics.reduced_gravity).
  /// `films`: null where no body can move freely.
  Response(const Samples& samples, std::vector<Vec3> buoyancy, std::unique_ptr<Seepage> films, double spacing,
           int threads);

  /// From the sums of the wet samples: extrapolated pressure of each into items.record (Adami, Hu and Adams 2012)
  ///   p_b = [sum V_k W p_k + (G - a_b) . sum V_k W rho_k (x_b - x_k)] / sum V_k W,
  /// velocity that the viscous term sees (2 v_b - mean of the fluid's) into extras.viscous, and the wrenches, which are
  /// minus the forces that accelerate() will put on the particles; viscous ones also turn the body by what the pairs
  /// leave out: between them acts mu du/dn, whose force on a closed surface is right, but whose torque lacks that of mu
  /// (grad u)^T n, -2 mu V spin for a body without slip. For a free body with mobility K and free acceleration a0
  ///   a = a0 + K (F - Q a),  F the wrench at a = 0, Q a the wrench that the term -a_b adds: one 6x6 system per body.
  void solve(Neighbourhood& items, ItemExtras& extras, const std::vector<SampleSums>& sums,
             const PassConstants& constants, std::span<const exchange::BodyState> states, Scheme scheme, Films films);

  /// Normals of the samples near fluid, into extras.normal.
  void place_normals(const Neighbourhood& items, std::span<const exchange::BodyState> states, ItemExtras& extras) const;

  /// Of the films; the samples' comes with the constants.
  void set_gravity(const Vec3& gravity) {
    if (films_) films_->set_gravity(gravity);
  }
  /// Fastest rate at which the viscous forces on the samples slow any free body, 1/s: largest eigenvalue of K times
  /// their change per twist.
  double drag_rate(const Neighbourhood& items, const std::vector<SampleSums>& sums,
                   std::span<const exchange::BodyState> states) const;

  /// Change of a body's acceleration by a wrench beside those that solve() knew. It has to move the water around it,
  /// too, whose pressure follows as in solve(): a light body takes a blow with the mass that it carries along.
  Eigen::Matrix<double, 6, 6> mobility_in_water(const exchange::BodyState& state, std::uint32_t body) const;
  /// The pressure that follows from such a change, into items.record and the body's wrench.
  void accelerate_body(Neighbourhood& items, std::uint32_t body, const Eigen::Matrix<double, 6, 1>& change);
  /// Adds a force on a wet sample's body, N, at `arm` from its centre of mass.
  void push(std::uint32_t sample, const Vec3& arm, const Vec3& force);
  /// Where the fluid touches each moving body, wet patches only: once all forces are known. `states`: those of the last
  /// solve().
  std::span<const exchange::Contact> gather_contacts(std::span<const exchange::BodyState> states);

  Seepage* films() const { return films_.get(); }  ///< null where no body can move freely

  /// What the next step takes from the last one: films without which a solve begins, wrenches for probes.
  template <class A>
  void state(A& a) {
    a("wrenches", wrenches_), a("acceleration", acceleration_);
    if (films_) a("films", *films_);
  }

  std::span<const exchange::Wrench> wrenches() const { return wrenches_; }
  std::size_t memory() const;  ///< bytes of all its arrays
  /// Acceleration that the extrapolation used, per body: linear, angular.
  std::span<const Eigen::Matrix<double, 6, 1>> accelerations() const { return acceleration_; }
  /// The same at a sample, m/s^2; zero if it is dry.
  Vec3 acceleration_of(std::uint32_t sample) const;

 private:
  static constexpr std::uint32_t kDry = ~0u;
  struct Wet {                    // one sample near fluid
    std::uint32_t sample = kDry;  // which, if it is wet
    std::uint32_t item, body;
    Eigen::Vector3f arm;    // world, from the centre of mass
    float penetration;      // of the nearest particle's edge below the surface, m
    float seen;             // pressure extrapolated without the body's acceleration
    float p0;               // the share of it that the sample bears
    Eigen::Vector3f reach;  // sum V W rho (x_b - x_k) / sum V W
    Eigen::Vector3f area;   // S: force per unit pressure
    Eigen::Vector3f force;  // what does not depend on p_b; from apply() on all, and what was pushed
  };
  struct Drag {              // the same in viscous fluids
    float mirror;            // see mirror()
    Eigen::Vector3f couple;  // torque of viscous forces beside that of `force` at `arm`
  };
  float mirror(float depth, float height) const;
  void collect(Neighbourhood& items, ItemExtras& extras, const std::vector<SampleSums>& sums,
               const PassConstants& constants, std::span<const exchange::BodyState> states);
  /// Q: minus the wrench by the pressure of the samples per acceleration of the body.
  Eigen::Matrix<double, 6, 6> added_mass(std::uint32_t body) const;
  Eigen::Matrix<double, 6, 1> film(std::size_t body) const;  ///< wrench of the films on it
  /// Calls what(wet) for the wet samples of a body, in their order.
  template <class Self, class What>
  static void for_each_wet(Self& self, std::uint32_t body, What&& what) {
    for (std::uint32_t k = self.samples_.first[body]; k < self.samples_.first[body + 1]; ++k)
      if (auto* wet = self.find(self.samples_.order[k])) what(*wet);
  }
  /// What is known of a sample, null if it is dry.
  const Wet* find(std::uint32_t sample) const {
    const std::uint32_t at = at_[sample];
    return at < wet_.size() && wet_[at].sample == sample ? &wet_[at] : nullptr;
  }
  Wet* find(std::uint32_t sample) { return const_cast<Wet*>(std::as_const(*this).find(sample)); }
  Vec3 couple(const Wet& wet) const {
    return drag_.empty() ? Vec3(0, 0, 0) : drag_[static_cast<std::size_t>(&wet - wet_.data())].couple.cast<double>();
  }
  void find_accelerations(std::span<const exchange::BodyState> states, Scheme scheme, bool films);
  void apply(Neighbourhood& items, std::span<const exchange::BodyState> states);

  /// Samples of one body in a row, few enough that a tank's are shared among the threads.
  struct Chunk {
    std::uint32_t body, begin, end;  // into samples_.order
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  };

  const Samples& samples_;
  std::vector<Chunk> chunks_;
  int threads_;
  double spacing_;
  std::vector<Vec3> buoyancy_;
  std::unique_ptr<Seepage> films_;
  std::vector<Wet> wet_;                  // samples near fluid, in item order
  std::vector<ViscousSums> viscous_;      // the same; viscous fluids only
  std::vector<Drag> drag_;                // the same
  std::vector<std::uint32_t> at_;         // by sample: its place in wet_, if that one names it
  Scheme scheme_ = Scheme::kInterlinked;  // of the last solve
  std::vector<exchange::Wrench> wrenches_;
  std::vector<Eigen::Matrix<double, 6, 1>> acceleration_;
  std::vector<Vec3> spin_;
  std::vector<exchange::Contact> patches_, contacts_;
};

}  // namespace ballast::fluid
