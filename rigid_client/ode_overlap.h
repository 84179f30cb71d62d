// Would a body overlap another one at a pose? Found with ODE's shapes, whatever engine moves the bodies.
#pragma once
#include <memory>
#include <optional>
#include <span>

#include "common/exchange/manifest.h"
#include "common/result.h"

namespace ballast::rigid {

class Overlap {
 public:
  static Result<std::unique_ptr<Overlap>> make(const exchange::ManifestView& manifest);
  ~Overlap();

  struct Found {
    std::size_t other;
    double depth;  ///< m
  };
  /// The deepest overlap of a dynamic body with any other at `states`; nothing if it is within contact tolerance.
  std::optional<Found> deepest(std::size_t body, std::span<const exchange::BodyState> states);

 private:
  struct Shapes;
  explicit Overlap(std::unique_ptr<Shapes> shapes);
  std::unique_ptr<Shapes> shapes_;
};

}  // namespace ballast::rigid
