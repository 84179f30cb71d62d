// Fluids by name at about 20 C, rounded so that scenes stay simple; every value can be overridden in the scene.
#pragma once
#include <string_view>

namespace ballast::scene {

struct Material {
  std::string_view name;
  double density;          ///< kg/m^3
  double viscosity;        ///< Pa s
  double surface_tension;  ///< N/m, against air
};

// water: IAPWS gives 998.2 kg/m^3, 1.0016e-3 Pa s and (R1-76) 0.07274 N/m; the first two are rounded.
// sea_water: 35 g/kg. Density 1024.8 kg/m^3 and viscosity 1.08e-3 Pa s after Sharqawy et al. 2010; surface tension
// after
//   Nayar et al. 2014: that of water times 1 + 3.766e-4 S + 2.347e-6 S T.
// honey: a thick one; real ones span 2 to 40 Pa s with water content, and 0.050 to 0.060 N/m.
// glycerol: pure; handbook values.
inline constexpr Material kMaterials[] = {
    {"water", 1000, 1.0e-3, 0.0727},
    {"sea_water", 1025, 1.08e-3, 0.0738},
    {"honey", 1420, 10, 0.055},
    {"glycerol", 1261, 1.41, 0.0634},
};
inline constexpr std::string_view kMaterialWords[] = {"water", "sea_water", "honey", "glycerol"};

}  // namespace ballast::scene
