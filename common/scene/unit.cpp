// Parser of numbers with units: one table of units, products, quotients and whole powers of them.
#include "common/scene/unit.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

namespace ballast::scene {
namespace {

/// A unit is value * up / down in SI. The quotient keeps decimal prefixes exact: 5 cm is the double 0.05.
struct Unit {
  std::string_view symbol;
  double up, down;
  Dims dims;
};

constexpr double kPi = std::numbers::pi;
constexpr Unit kUnits[] = {
    {"m", 1, 1, {1, 0, 0, 0}},       {"mm", 1, 1e3, {1, 0, 0, 0}},     {"cm", 1, 100, {1, 0, 0, 0}},
    {"km", 1e3, 1, {1, 0, 0, 0}},    {"kg", 1, 1, {0, 1, 0, 0}},       {"g", 1, 1e3, {0, 1, 0, 0}},
    {"t", 1e3, 1, {0, 1, 0, 0}},     {"s", 1, 1, {0, 0, 1, 0}},        {"ms", 1, 1e3, {0, 0, 1, 0}},
    {"us", 1, 1e6, {0, 0, 1, 0}},    {"min", 60, 1, {0, 0, 1, 0}},     {"h", 3600, 1, {0, 0, 1, 0}},
    {"rad", 1, 1, {0, 0, 0, 1}},     {"deg", kPi, 180, {0, 0, 0, 1}},  {"Hz", 1, 1, {0, 0, -1, 0}},
    {"rpm", kPi, 30, {0, 0, -1, 1}}, {"N", 1, 1, {1, 1, -2, 0}},       {"mN", 1, 1e3, {1, 1, -2, 0}},
    {"kN", 1e3, 1, {1, 1, -2, 0}},   {"Pa", 1, 1, {-1, 1, -2, 0}},     {"mPa", 1, 1e3, {-1, 1, -2, 0}},
    {"kPa", 1e3, 1, {-1, 1, -2, 0}}, {"MPa", 1e6, 1, {-1, 1, -2, 0}},  {"bar", 1e5, 1, {-1, 1, -2, 0}},
    {"J", 1, 1, {2, 1, -2, 0}},      {"W", 1, 1, {2, 1, -3, 0}},       {"L", 1, 1e3, {3, 0, 0, 0}},
    {"%", 1, 100, {0, 0, 0, 0}},     {"spacings", 1, 1, {1, 0, 0, 0}}, {"spacing", 1, 1, {1, 0, 0, 0}},
    {"1", 1, 1, {0, 0, 0, 0}},
};

constexpr Quantity kNamed[] = {kLength,        kMass,         kTime,         kAngle,
                               kFrequency,     kSpeed,        kAngularSpeed, kDensity,
                               kViscosity,     kAcceleration, kTorque,       kSurfaceTension,
                               kDamping,       kPressureUnit, kForceUnit,    kAngularStiffness,
                               kAngularDamping};

std::string_view trim(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
  return s;
}

/// The product of units that a text such as "kg/m^3" stands for.
struct Product {
  double up = 1, down = 1;
  Dims dims;
  bool percent = false, spacings = false;

  void times(const Unit& unit, int power) {
    const double up_power = std::pow(unit.up, std::abs(power)), down_power = std::pow(unit.down, std::abs(power));
    up *= power > 0 ? up_power : down_power;
    down *= power > 0 ? down_power : up_power;
    dims.length += power * unit.dims.length;
    dims.mass += power * unit.dims.mass;
    dims.time += power * unit.dims.time;
    dims.angle += power * unit.dims.angle;
    percent = percent || unit.symbol == "%";
  }
};

std::string known_units() {
  std::string list;
  for (const Unit& unit : kUnits) {
    if (unit.symbol != "1" && unit.symbol != "spacing") list += (list.empty() ? "" : ", ") + std::string(unit.symbol);
  }
  return list;
}

std::string unit_cure() { return "Use " + known_units() + ", joined by a space or /, with powers such as m^3."; }

const Unit* find_unit(std::string_view symbol) {
  for (const Unit& unit : kUnits) {
    if (unit.symbol == symbol) return &unit;
  }
  return nullptr;
}

/// Takes "^3" off the front of `rest`; 1 where there is none, nothing where it is malformed.
std::optional<int> take_power(std::string_view& rest) {
  if (rest.empty() || rest.front() != '^') return 1;
  int power = 0;
  const auto [end, error] = std::from_chars(rest.data() + 1, rest.data() + rest.size(), power);
  if (error != std::errc() || power == 0 || std::abs(power) > 6) return std::nullopt;
  rest.remove_prefix(static_cast<size_t>(end - rest.data()));
  return power;
}

/// "/" acts on the one unit behind it: kg/m s is (kg/m) s, as everywhere in SI texts.
Result<Product> parse_units(std::string_view text, double spacing) {
  Product product;
  std::string_view rest = trim(text);
  int sign = 1;
  while (!rest.empty()) {
    const size_t end = std::min(rest.find_first_of("^/* \t"), rest.size());
    const std::string_view symbol = rest.substr(0, end);
    const Unit* unit = find_unit(symbol);
    if (unit == nullptr) return Error{fmt::format("the unit '{}' is not known", symbol), unit_cure(), ""};
    rest.remove_prefix(end);
    const auto power = take_power(rest);
    if (!power)
      return Error{fmt::format("the power behind '{}' is not a whole number from -6 to 6", symbol), unit_cure(), ""};
    product.times(*unit, sign * *power);
    if (symbol.starts_with("spacing")) {
      if (spacing <= 0) {
        return Error{"a length in spacings needs world.spacing, which is 0 or not set", "Set world.spacing in metres.",
                     ""};
      }
      product.times({"", spacing, 1, {}}, sign * *power);
    }
    rest = trim(rest);
    sign = 1;
    if (!rest.empty() && (rest.front() == '/' || rest.front() == '*')) {
      sign = rest.front() == '/' ? -1 : 1;
      rest = trim(rest.substr(1));
      if (rest.empty()) return Error{fmt::format("'{}' ends in the middle of a unit", text), unit_cure(), ""};
    }
  }
  return product;
}

std::string with_article(std::string_view noun) {
  return fmt::format("{} {}", std::string_view("aeiou").find(noun.front()) == std::string_view::npos ? "a" : "an",
                     noun);
}

std::string dims_name(const Dims& dims) {
  if (dims == Dims{}) return "a plain number";
  for (const Quantity& quantity : kNamed) {
    if (quantity.dims == dims) return fmt::format("{} ({})", with_article(quantity.name), quantity.unit);
  }
  return fmt::format("of the dimension m^{} kg^{} s^{} rad^{}", dims.length, dims.mass, dims.time, dims.angle);
}

Error wrong_dimension(std::string_view text, const Dims& seen, const Quantity& wanted) {
  const bool plain = wanted.dims == Dims{};
  return {
      fmt::format("'{}' is {}, but {}{} is needed", text, dims_name(seen), with_article(wanted.name),
                  plain ? "" : fmt::format(" ({})", wanted.unit)),
      plain ? "Write the number without a unit." : fmt::format("Write it in {} or leave the unit out.", wanted.unit),
      ""};
}

}  // namespace

Result<Measure> parse_measure(std::string_view text, const Quantity& quantity, double spacing) {
  const std::string_view whole = trim(text);
  std::string_view rest = whole;
  if (rest.starts_with('+')) rest.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error == std::errc::result_out_of_range) {
    return Error{fmt::format("'{}' is outside the range of numbers", whole), "Use a value between 1e-300 and 1e300.",
                 ""};
  }
  if (error != std::errc()) {
    return Error{fmt::format("'{}' is not a number", whole),
                 fmt::format("Write {}, such as {}.", with_article(quantity.name),
                             trim(fmt::format("1.5 {}", quantity.any ? "" : quantity.unit))),
                 ""};
  }
  if (!std::isfinite(number)) {
    return Error{fmt::format("'{}' is not a finite number", whole), "Write a finite number.", ""};
  }
  rest.remove_prefix(static_cast<size_t>(end - rest.data()));
  if (trim(rest).empty()) return Measure{number, false};
  auto units = parse_units(rest, spacing);
  if (!units) {
    return Error{fmt::format("in '{}', {}", whole, units.error().what), units.error().cure, ""};
  }
  if (!quantity.any && units->dims != quantity.dims) return wrong_dimension(whole, units->dims, quantity);
  const double value = number * units->up / units->down;
  if (!std::isfinite(value)) {
    return Error{fmt::format("'{}' is outside the range of numbers", whole), "Use a value between 1e-300 and 1e300.",
                 ""};
  }
  return Measure{value, units->percent};
}

Result<long long> parse_integer(std::string_view text) {
  std::string_view rest = trim(text);
  if (rest.starts_with('+')) rest.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (error != std::errc() || end != rest.data() + rest.size()) {
    return Error{fmt::format("'{}' is not a whole number", text), "Write a whole number without unit, such as 3.", ""};
  }
  return value;
}

}  // namespace ballast::scene
