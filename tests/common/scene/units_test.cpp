// Numbers with units against values worked out by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "common/scene/unit.h"

namespace ballast::scene {
namespace {

using ::testing::HasSubstr;

struct Good {
  const char* text;
  Quantity quantity;
  double value;
};

class GoodUnits : public ::testing::TestWithParam<Good> {};

TEST_P(GoodUnits, BecomeSiExactly) {
  const auto& [text, quantity, value] = GetParam();
  const auto measure = parse_measure(text, quantity, 0.02);
  ASSERT_TRUE(measure) << text << ": " << measure.error().text();
  EXPECT_DOUBLE_EQ(measure->value, value) << text;
}

constexpr double kPi = std::numbers::pi;
INSTANTIATE_TEST_SUITE_P(
    Table, GoodUnits,
    ::testing::Values(Good{"5 cm", kLength, 0.05}, Good{"5cm", kLength, 0.05}, Good{"-2.5e1 mm", kLength, -0.025},
                      Good{"+3 km", kLength, 3000}, Good{"7", kLength, 7}, Good{" 7 ", kNone, 7},
                      Good{"0.2 spacings", kLength, 0.004}, Good{"1 spacing", kLength, 0.02},
                      Good{"1000 kg/m^3", kDensity, 1000}, Good{"1 g/cm^3", kDensity, 1000},
                      Good{"1.2 kg/L", kDensity, 1200}, Good{"30 deg", kAngle, kPi / 6}, Good{"20 ms", kTime, 0.02},
                      Good{"2 min", kTime, 120}, Good{"0.5 h", kTime, 1800}, Good{"4 %", kNone, 0.04},
                      Good{"1 Pa s", kViscosity, 1}, Good{"1 Pa*s", kViscosity, 1}, Good{"1 mPa s", kViscosity, 1e-3},
                      Good{"1 kg/m/s", kViscosity, 1}, Good{"0.1 N/m", kSurfaceTension, 0.1},
                      Good{"72.8 mN/m", kSurfaceTension, 0.0728}, Good{"36 km/h", kSpeed, 10},
                      Good{"981 cm/s^2", kAcceleration, 9.81}, Good{"2 m s^-2", kAcceleration, 2},
                      Good{"60 rpm", kAngularSpeed, 2 * kPi}, Good{"180 deg/s", kAngularSpeed, kPi},
                      Good{"1 bar", kPressureUnit, 1e5}, Good{"2 kN m", kTorque, 2000},
                      Good{"3 N m/deg", kAngularStiffness, 540 / kPi}, Good{"3 N m s/rad", kAngularDamping, 3},
                      Good{"5 Hz", kFrequency, 5}, Good{"5 1/s", kFrequency, 5}, Good{"3 cm", kAnyQuantity, 0.03}));

TEST(Units, CentimetresGiveTheSameDoubleAsMetres) {
  for (int i = 0; i <= 1000; ++i) {
    const auto centimetres = parse_measure(std::to_string(i) + " cm", kLength, 0);
    ASSERT_TRUE(centimetres);
    EXPECT_EQ(centimetres->value, i / 100.0);
  }
}

struct Bad {
  const char* text;
  Quantity quantity;
  const char* what;
};

class BadUnits : public ::testing::TestWithParam<Bad> {};

TEST_P(BadUnits, AreRefusedWithReasonAndCure) {
  const auto& [text, quantity, what] = GetParam();
  const auto measure = parse_measure(text, quantity, 0);
  ASSERT_FALSE(measure) << text << " gave " << measure->value;
  EXPECT_THAT(measure.error().what, HasSubstr(what));
  EXPECT_FALSE(measure.error().cure.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadUnits,
    ::testing::Values(
        Bad{"5 cm", kDensity, "'5 cm' is a length (m), but a density (kg/m^3) is needed"},
        Bad{"5 cm", kNone, "but a plain number is needed"}, Bad{"4 %", kLength, "is a plain number, but a length"},
        Bad{"5 m^5", kLength, "m^5 kg^0 s^0 rad^0"}, Bad{"5 furlongs", kLength, "'furlongs' is not known"},
        Bad{"five", kLength, "not a number"}, Bad{"", kLength, "not a number"}, Bad{"nan", kLength, "not a finite"},
        Bad{"inf", kLength, "not a finite"}, Bad{"-inf m", kLength, "not a finite"},
        Bad{".inf", kLength, "not a number"}, Bad{"1e999", kLength, "outside the range"},
        Bad{"1e308 km", kLength, "outside the range"}, Bad{"1 kg/", kMass, "middle of a unit"},
        Bad{"1 m^x", kLength, "power"}, Bad{"1 m^99", kLength, "power"}, Bad{"2 spacings", kLength, "world.spacing"},
        Bad{"1 N m", kAngularStiffness, "angular stiffness (N m/rad)"}));

TEST(WholeNumbers, AreReadWithoutUnitOrFraction) {
  ASSERT_TRUE(parse_integer("-12"));
  EXPECT_EQ(*parse_integer("-12"), -12);
  EXPECT_FALSE(parse_integer("1.5"));
  EXPECT_FALSE(parse_integer("3 m"));
  EXPECT_FALSE(parse_integer("99999999999999999999"));
}

}  // namespace
}  // namespace ballast::scene
