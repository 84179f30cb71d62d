// One overload per form of value.
#include "common/scene/read_value.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "common/scene/nearest.h"

namespace ballast::scene {
namespace {

std::string_view kind_name(Node::Kind kind) {
  switch (kind) {
    case Node::Kind::kNothing:
      return "nothing";
    case Node::Kind::kText:
      return "a plain value";
    case Node::Kind::kList:
      return "a list";
    case Node::Kind::kMap:
      return "a map";
  }
  return "";
}

std::string example(const Field& field, size_t count) {
  std::string numbers = "1";
  for (size_t i = 1; i < count; ++i) numbers += ", 1";
  if (count == 1)
    return fmt::format("Write {}: {}{}{}.", field.name, 1, *field.quantity.unit ? " " : "", field.quantity.unit);
  return fmt::format("Write {}: [{}]{}{}.", field.name, numbers, *field.quantity.unit ? ", in " : "",
                     field.quantity.unit);
}

std::string range_text(const Range& range, const Quantity& quantity) {
  const std::string_view unit = quantity.unit, gap = unit.empty() ? "" : " ";
  const bool low = std::isfinite(range.min), high = std::isfinite(range.max);
  if (low && high && range.min == range.max) return fmt::format("{}{}{}", range.min, gap, unit);
  if (low && high) return fmt::format("from {} to {}{}{}", range.min, range.max, gap, unit);
  if (low) return fmt::format("{} {}{}{}", range.open ? "greater than" : "at least", range.min, gap, unit);
  return fmt::format("at most {}{}{}", range.max, gap, unit);
}

void check_range(ReadState& state, const Field& field, const Node& node, double value, const Quantity& quantity) {
  const Range& range = field.range;
  const bool tiny = range.open && range.min == 0 && value > 0 && value < quantity.least;
  if (tiny || std::abs(value) > quantity.most) {
    return state.fail(node.place,
                      fmt::format("{} is {}, which no {} in a scene is", field.name, node.text, quantity.name),
                      fmt::format("Use a value of {} {:g}{}{}; is the unit right?", tiny ? "at least" : "at most",
                                  tiny ? quantity.least : quantity.most, *quantity.unit ? " " : "", quantity.unit));
  }
  if (value >= range.min && value <= range.max && !(range.open && value == range.min)) return;
  state.fail(node.place, fmt::format("{} is {}, which is out of range", field.name, node.text),
             fmt::format("Use a value {}.", range_text(range, field.quantity)));
}

std::optional<Measure> read_measure(ReadState& state, const Field& field, const Node& node, const Quantity& quantity) {
  if (!plain_text(state, field, node, "a number")) return std::nullopt;
  const auto measure = parse_measure(node.text, quantity, state.spacing);
  if (!measure) {
    state.fail(node.place, fmt::format("{}: {}", field.name, measure.error().what), measure.error().cure);
    return std::nullopt;
  }
  return *measure;
}

std::optional<double> read_number(ReadState& state, const Field& field, const Node& node, const Quantity& quantity) {
  const auto measure = read_measure(state, field, node, quantity);
  if (!measure) return std::nullopt;
  check_range(state, field, node, measure->value, quantity);
  return measure->value;
}

/// A list of exactly `count` items.
bool is_list_of(ReadState& state, const Field& field, const Node& node, size_t count) {
  if (!is_kind(state, field, node, Node::Kind::kList)) return false;
  if (node.list.size() == count) return true;
  state.fail(node.place, fmt::format("{} has {} values, but {} are needed", field.name, node.list.size(), count),
             example(field, count));
  return false;
}

std::optional<Vec3> read_vector(ReadState& state, const Field& field, const Node& node) {
  if (!is_list_of(state, field, node, 3)) return std::nullopt;
  Vec3 vector = Vec3::Zero();
  for (int i = 0; i < 3 && !state.error; ++i) {
    vector[i] = read_number(state, field, node.list[size_t(i)], field.quantity).value_or(0);
  }
  return vector;
}

/// Gazebo's convention: rotations about the fixed axes x, then y, then z.
Quat from_angles(double roll, double pitch, double yaw) {
  return Quat(Eigen::AngleAxisd(yaw, Vec3::UnitZ()) * Eigen::AngleAxisd(pitch, Vec3::UnitY()) *
              Eigen::AngleAxisd(roll, Vec3::UnitX()));
}

/// Unit vectors as printed stay as they are to the last bit; only input with few digits is put right.
bool is_unit_to_rounding(double norm) { return std::abs(norm - 1) < 1e-12; }

}  // namespace

void ReadState::fail(const Place& place, std::string what, std::string cure) {
  if (!error) error = error_at(place, std::move(what), std::move(cure));
}

Place ReadState::find(Place base, std::initializer_list<std::string_view> keys) const {
  for (const std::string_view key : keys) {
    const auto it = places.find({where(base), std::string(key)});
    if (it == places.end()) break;
    base = it->second;
  }
  return base;
}

bool is_kind(ReadState& state, const Field& field, const Node& node, Node::Kind kind) {
  if (node.kind == kind) return true;
  if (node.kind == Node::Kind::kNothing) {
    state.fail(node.place, fmt::format("{} has no value", field.name), "Give it one, or remove the key.");
  } else {
    state.fail(node.place, fmt::format("{} is {}, but {} is needed", field.name, kind_name(node.kind), kind_name(kind)),
               kind == Node::Kind::kMap ? fmt::format("Write {}: {{ key: value, ... }}.", field.name)
               : kind == Node::Kind::kList
                   ? fmt::format("Write {}: [ ..., ... ], or one line starting with '-' per item.", field.name)
                   : fmt::format("Write {}: value.", field.name));
  }
  return false;
}

const std::string* plain_text(ReadState& state, const Field& field, const Node& node, std::string_view form) {
  if (node.kind == Node::Kind::kText && !node.text.empty()) return &node.text;
  if (node.kind == Node::Kind::kNothing || node.kind == Node::Kind::kText) {
    state.fail(node.place, fmt::format("{} has no value", field.name),
               fmt::format("Give it {}, or remove the key.", form));
  } else {
    state.fail(node.place, fmt::format("{} is {}, but {} is needed", field.name, kind_name(node.kind), form),
               fmt::format("Write {} as {}.", field.name, form));
  }
  return nullptr;
}

std::optional<size_t> read_word(ReadState& state, const Field& field, const Node& node,
                                const std::vector<std::string>& words) {
  const std::string* text = plain_text(state, field, node, "a word");
  if (!text) return std::nullopt;
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == *text) return i;
  }
  state.fail(node.place, fmt::format("{} '{}' is not known", field.name, *text), suggestion(*text, words));
  return std::nullopt;
}

void read_value(ReadState& state, const Field& field, const Node& node, double& out) {
  if (const auto number = read_number(state, field, node, field.quantity)) out = *number;
}

void read_value(ReadState& state, const Field& field, const Node& node, std::optional<double>& out) {
  if (const auto number = read_number(state, field, node, field.quantity)) out = *number;
}

void read_value(ReadState& state, const Field& field, const Node& node, int& out) {
  if (!plain_text(state, field, node, "a whole number")) return;
  const auto number = parse_integer(node.text);
  if (!number) {
    state.fail(node.place, fmt::format("{}: {}", field.name, number.error().what), number.error().cure);
  } else if (*number < std::numeric_limits<int>::min() || *number > std::numeric_limits<int>::max()) {
    state.fail(node.place, fmt::format("{} is {}, which is out of range", field.name, node.text),
               "Use a smaller number.");
  } else {
    check_range(state, field, node, static_cast<double>(*number), field.quantity);
    out = static_cast<int>(*number);
  }
}

void read_value(ReadState& state, const Field& field, const Node& node, std::uint64_t& out) {
  if (!plain_text(state, field, node, "a whole number")) return;
  const char* const end = node.text.data() + node.text.size();
  const auto [stop, error] = std::from_chars(node.text.data(), end, out);
  if (error == std::errc() && stop == end) return;
  state.fail(node.place, fmt::format("{}: '{}' is not a whole number from 0 to 2^64 - 1", field.name, node.text),
             fmt::format("Write {}: 1.", field.name));
}

void read_value(ReadState& state, const Field& field, const Node& node, bool& out) {
  const auto word = read_word(state, field, node, {"true", "false"});
  if (word) out = *word == 0;
}

void read_value(ReadState& state, const Field& field, const Node& node, std::string& out) {
  const std::string* text = plain_text(state, field, node, "a text");
  if (!text) return;
  if (field.words.empty() || read_word(state, field, node, {field.words.begin(), field.words.end()})) out = *text;
}

void read_value(ReadState& state, const Field& field, const Node& node, Vec3& out) {
  if (const auto vector = read_vector(state, field, node)) out = *vector;
}

void read_value(ReadState& state, const Field& field, const Node& node, std::array<int, 3>& out) {
  if (!is_list_of(state, field, node, 3)) return;
  for (size_t i = 0; i < 3; ++i) read_value(state, field, node.list[i], out[i]);
}

void read_value(ReadState& state, const Field& field, const Node& node, Quat& out) {
  const bool quaternion = node.list.size() == 4;
  if (!is_list_of(state, field, node, quaternion ? 4 : 3)) return;
  double x[4] = {};
  for (size_t i = 0; i < node.list.size(); ++i) {
    x[i] = read_number(state, field, node.list[i], quaternion ? kNone : kAngle).value_or(0);
  }
  if (!quaternion) {
    out = from_angles(x[0], x[1], x[2]);
    return;
  }
  const Quat q(x[0], x[1], x[2], x[3]);
  if (std::abs(q.norm() - 1) > 1e-3) {
    return state.fail(node.place,
                      fmt::format("the quaternion of {} has the length {:.4g}, not 1", field.name, q.norm()),
                      "Write a unit quaternion [w, x, y, z], or [roll, pitch, yaw].");
  }
  out = is_unit_to_rounding(q.norm()) ? q : q.normalized();
}

void read_value(ReadState& state, const Field& field, const Node& node, Name out) {
  const std::string* text = plain_text(state, field, node, "a name");
  if (!text) return;
  const bool plain =
      text->find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") == std::string::npos;
  if (!plain) {
    return state.fail(node.place, fmt::format("{}: '{}' is not a name", field.name, *text),
                      "Use letters, digits, _ and - only: names become parts of columns and paths.");
  }
  out.text = *text;
}

void read_value(ReadState& state, const Field& field, const Node& node, MeshFile out) {
  const std::string* text = plain_text(state, field, node, "a file name");
  if (!text) return;
  const auto path = std::filesystem::absolute(std::filesystem::path(state.folder) / *text).lexically_normal();
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) {
    return state.fail(node.place, fmt::format("{}: there is no file '{}'", field.name, path.string()),
                      "Give a path relative to the scene file, or an absolute one.");
  }
  out.path = path.string();
}

void read_value(ReadState& state, const Field& field, const Node& node, Axis out) {
  const auto vector = read_vector(state, field, node);
  if (!vector || state.error) return;
  const double norm = vector->norm();
  if (!(norm > 0) || !std::isfinite(norm)) {
    return state.fail(node.place, fmt::format("{} has no direction: its length is {}", field.name, norm),
                      fmt::format("Write a unit vector, such as {}: [0, 0, 1].", field.name));
  }
  if (std::abs(norm - 1) > 1e-3) {
    const Vec3 unit = vector->normalized();
    return state.fail(node.place, fmt::format("{} has the length {:.6g}, not 1", field.name, norm),
                      fmt::format("Write {}: [{:.6g}, {:.6g}, {:.6g}].", field.name, unit.x(), unit.y(), unit.z()));
  }
  out.vector = is_unit_to_rounding(norm) ? *vector : vector->normalized();
}

void read_value(ReadState& state, const Field& field, const Node& node, Factors out) {
  if (node.kind == Node::Kind::kList) return read_value(state, field, node, out.vector);
  if (const auto number = read_number(state, field, node, field.quantity)) out.vector.setConstant(*number);
}

void read_value(ReadState& state, const Field& field, const Node& node, Ground out) {
  if (!is_list_of(state, field, node, 2)) return;
  for (int i = 0; i < 2; ++i) {
    out.point[i] = read_number(state, field, node.list[size_t(i)], field.quantity).value_or(0);
  }
}

void read_value(ReadState& state, const Field& field, const Node& node, Axes out) {
  if (!is_kind(state, field, node, Node::Kind::kList)) return;
  out.on = {};
  for (const Node& item : node.list) {
    const auto axis = read_word(state, field, item, {"x", "y", "z"});
    if (axis && out.on[*axis])
      state.fail(item.place, fmt::format("{} names the axis {} twice", field.name, item.text), "Remove one.");
    if (axis) out.on[*axis] = true;
  }
}

// A number of particles other than 0 would depend on world.spacing.
void read_value(ReadState& state, const Field& share, const Node& node, MostLost out) {
  const bool percent = node.kind == Node::Kind::kText && node.text.find('%') != std::string::npos;
  Field field = share;
  if (!percent) field.range = kAnyNumber;
  const auto number = read_number(state, field, node, field.quantity);
  if (!number) return;
  if (*number != 0 && !percent) {
    return state.fail(node.place, fmt::format("{} is {}, which is neither 0 nor a share", field.name, node.text),
                      fmt::format("Write {0}: 0, or {0}: 5 % where fluid is meant to leave.", field.name));
  }
  if (percent)
    out.share = *number;
  else
    out.count = 0;
}

void read_value(ReadState& state, const Field& field, const Node& node, Tolerance out) {
  const bool percent = node.kind == Node::Kind::kText && node.text.find('%') != std::string::npos;
  const auto number = read_number(state, field, node, percent ? kNone : field.quantity);
  if (number) (percent ? out.relative : out.absolute) = *number;
}

void read_pose_list(ReadState& state, const Node& node, Pose& out) {
  const Field field{"pose", kLength, ""};
  if (node.list.size() != 3 && node.list.size() != 6) {
    return state.fail(node.place, fmt::format("pose has {} values, but 3 or 6 are needed", node.list.size()),
                      "Write [x, y, z], [x, y, z, roll, pitch, yaw] or { position: [...], rotation: [...] }.");
  }
  double x[6] = {};
  for (size_t i = 0; i < node.list.size(); ++i) {
    x[i] = read_number(state, field, node.list[i], i < 3 ? kLength : kAngle).value_or(0);
  }
  out = {Vec3(x[0], x[1], x[2]), from_angles(x[3], x[4], x[5])};
}

}  // namespace ballast::scene
