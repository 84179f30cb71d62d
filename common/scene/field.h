// What the lists of keys in fields.h are made of: the description of one key, and the forms that a value can have.
#pragma once
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "common/scene/scene.h"
#include "common/scene/unit.h"

namespace ballast::scene {

/// Allowed numbers: min <= x <= max, with min itself left out if `open`. Holds for every element of a list.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open = false;
};
inline constexpr Range kAnyNumber{};
inline constexpr Range kPositive{0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range kNotNegative{0, std::numeric_limits<double>::infinity(), false};
inline constexpr Range kFraction{0, 1, false};

/// One key of a scene file.
struct Field {
  std::string_view name;
  Quantity quantity;
  std::string_view help;
  Range range = kAnyNumber;
  bool required = false;
  std::span<const std::string_view> words = {};  ///< for texts: what may be written
};
inline constexpr bool kRequired = true;

// Views of a member as a form of text in the file.
struct Name {
  std::string& text;
};  // letters, digits, _ and -
struct MeshFile {
  std::string& path;
};  // relative to the scene file, made absolute
struct Axis {
  Vec3& vector;
};  // unit vector
struct Factors {
  Vec3& vector;
};  // one number or three
struct Ground {
  Vec3& point;
};  // [x, y]
struct Axes {
  std::array<bool, 3>& on;
};  // [x, z]
struct MostLost {
  std::optional<double>&count, &share;
};                  // the number 0, or a share such as "5 %"
struct Tolerance {  // "0.1 m" or "4 %"
  std::optional<double>&absolute, &relative;
};

/// `repeat` of a model; never reaches the Scene.
struct Repeat {
  std::array<int, 3> count{1, 1, 1};
  Vec3 step = Vec3::Zero();  ///< m, world axes
  bool given = false;
};

template <class E>
using WordTable = std::span<const std::pair<E, std::string_view>>;

inline constexpr std::pair<Accuracy, std::string_view> kAccuracyWords[] = {
    {Accuracy::kInteractive, "interactive"}, {Accuracy::kBalanced, "balanced"}, {Accuracy::kAccurate, "accurate"}};
inline constexpr std::pair<JointKind, std::string_view> kJointWords[] = {{JointKind::kFixed, "fixed"},
                                                                         {JointKind::kRevolute, "revolute"},
                                                                         {JointKind::kPrismatic, "prismatic"},
                                                                         {JointKind::kBall, "ball"},
                                                                         {JointKind::kUniversal, "universal"}};
inline constexpr std::pair<When, std::string_view> kWhenWords[] = {
    {When::kAuto, "auto"}, {When::kAlways, "always"}, {When::kNever, "never"}};
inline constexpr std::pair<Pressure, std::string_view> kPressureWords[] = {
    {Pressure::kAuto, "auto"}, {Pressure::kWcsph, "wcsph"}, {Pressure::kImplicit, "implicit"}};
inline constexpr std::pair<KernelKind, std::string_view> kKernelWords[] = {
    {KernelKind::kAuto, "auto"}, {KernelKind::kCubic, "cubic"}, {KernelKind::kWendland, "wendland"}};

inline WordTable<Accuracy> words_of(Accuracy) { return kAccuracyWords; }
inline WordTable<JointKind> words_of(JointKind) { return kJointWords; }
inline WordTable<When> words_of(When) { return kWhenWords; }
inline WordTable<Pressure> words_of(Pressure) { return kPressureWords; }
inline WordTable<KernelKind> words_of(KernelKind) { return kKernelWords; }

inline constexpr std::string_view kEngineWords[] = {"ode", "free_body"};
inline constexpr std::string_view kSchemeWords[] = {"auto", "interlinked", "iterated", "staggered"};
inline constexpr std::string_view kStatisticWords[] = {"last",    "mean", "min",    "max",
                                                       "max_abs", "rms",  "change", "slope"};

}  // namespace ballast::scene
