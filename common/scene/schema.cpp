// JSON Schema of a scene file, and help for people, from the lists of keys.
#include <fmt/format.h>

#include <algorithm>

#include "common/scene/keys.h"
#include "common/scene/print_fields.h"
#include "common/scene/reader.h"

namespace ballast {
namespace scene {
namespace {

/// Collects the properties of one map; structs become definitions of their own, so that shapes can hold shapes.
class Schema {
 public:
  static constexpr bool kReads = false, kPrints = false;
  Schema(Tree& definitions, Tree& object) : definitions_(definitions), object_(object) {
    object_ = {{"type", "object"}, {"additionalProperties", false}, {"properties", Tree::object()}};
  }

  template <class T>
  void operator()(const Field& field, T&& value) {
    Tree tree = describe(field, value);
    if constexpr (requires { Printer::tree_of(value); }) {
      const Tree standard = Printer::tree_of(value);
      const bool says_something = !standard.is_null() && !standard.is_object();
      const bool allowed = !standard.is_number() || !field.range.open || standard.get<double>() > field.range.min;
      if (!field.required && !in_option_ && says_something && allowed) tree["default"] = standard;
    }
    add(field, std::move(tree));
  }
  template <class List>
  void group(const Field& field, List&& list) {
    Tree inner;
    Schema schema(definitions_, inner);
    list(schema);
    add(field, std::move(inner));
  }
  template <class Form, class Code, class T>
  void option(const Field& field, Form, const Code&, T&& value) {
    options_.push_back(std::string(field.name));
    in_option_ = true;
    (*this)(field, value);
    in_option_ = false;
  }
  template <class Form, class Code, class List>
  void option_group(const Field& field, Form, const Code&, List&& list) {
    options_.push_back(std::string(field.name));
    group(field, list);
  }
  template <class Form, class Code>
  void flag(const Field& field, Form, const Code&) {
    add(field, {{"type", "boolean"}, {"default", false}});
  }
  void needs_option(std::string_view) {
    for (const std::string& key : options_) object_["oneOf"].push_back({{"required", Tree::array({key})}});
  }
  void either(const Field& a, double& x, const Field& b, double& y) {
    in_option_ = true;
    (*this)(a, x);
    (*this)(b, y);
    in_option_ = false;
    object_["not"] = {{"required", Tree::array({std::string(a.name), std::string(b.name)})}};
  }
  template <class List>
  void when(bool, std::string_view whose, List&& list) {
    only_for_ = whose;
    list(*this);
    only_for_ = {};
  }

 private:
  void add(const Field& field, Tree tree) {
    std::string help(field.help);
    if (*field.quantity.unit) help += fmt::format("{}[{}]", help.empty() ? "" : " ", field.quantity.unit);
    if (!only_for_.empty()) help += fmt::format("{}(only for {})", help.empty() ? "" : " ", only_for_);
    if (!help.empty()) tree["description"] = help;
    if (field.required) object_["required"].push_back(std::string(field.name));
    object_["properties"][std::string(field.name)] = std::move(tree);
  }

  /// A number, or a text with a unit.
  static Tree number(const Field& field) {
    Tree plain = {{"type", "number"}};
    if (std::isfinite(field.range.min)) plain[field.range.open ? "exclusiveMinimum" : "minimum"] = field.range.min;
    if (std::isfinite(field.range.max)) plain["maximum"] = field.range.max;
    return {{"anyOf", {plain, {{"type", "string"}, {"pattern", "^[-+]?[0-9.]"}}}}};
  }
  static Tree whole(const Field& field) {
    Tree tree = {{"type", "integer"}};
    if (std::isfinite(field.range.min)) tree["minimum"] = static_cast<long long>(field.range.min);
    if (std::isfinite(field.range.max)) tree["maximum"] = static_cast<long long>(field.range.max);
    return tree;
  }
  static Tree list(const Tree& item, int count) {
    return {{"type", "array"}, {"items", item}, {"minItems", count}, {"maxItems", count}};
  }
  static Tree words(const Tree& list) { return {{"enum", list}}; }

  Tree describe(const Field& field, double&) { return number(field); }
  Tree describe(const Field& field, std::optional<double>&) { return number(field); }
  Tree describe(const Field& field, int&) { return whole(field); }
  Tree describe(const Field&, std::uint64_t&) { return {{"type", "integer"}, {"minimum", 0}}; }
  Tree describe(const Field&, bool&) { return {{"type", "boolean"}}; }
  Tree describe(const Field& field, std::string&) {
    if (field.words.empty()) return {{"type", "string"}, {"minLength", 1}};
    Tree tree = Tree::array();
    for (const auto word : field.words) tree.push_back(std::string(word));
    return words(tree);
  }
  Tree describe(const Field& field, Vec3&) { return list(number(field), 3); }
  Tree describe(const Field& field, std::array<int, 3>&) { return list(whole(field), 3); }
  Tree describe(const Field& field, Quat&) { return {{"anyOf", {list(number(field), 3), list(number(field), 4)}}}; }
  Tree describe(const Field&, const Name&) { return {{"type", {"string", "integer"}}}; }
  Tree describe(const Field&, const MeshFile&) { return {{"type", "string"}, {"minLength", 1}}; }
  Tree describe(const Field& field, const Axis&) { return list(number(field), 3); }
  Tree describe(const Field& field, const Factors&) { return {{"anyOf", {number(field), list(number(field), 3)}}}; }
  Tree describe(const Field& field, const Ground&) { return list(number(field), 2); }
  Tree describe(const Field&, const Axes&) { return {{"type", "array"}, {"items", words({"x", "y", "z"})}}; }
  Tree describe(const Field&, const MostLost&) {
    return {{"anyOf", {{{"const", 0}}, {{"type", "string"}, {"pattern", "%$"}}}}};
  }
  Tree describe(const Field& field, const Tolerance&) { return number(field); }
  Tree describe(const Field& field, Pose& pose) {
    const Field length{"", kLength, ""};
    return {{"anyOf", {list(number(length), 3), list(number(length), 6), definition(field, "pose", pose)}}};
  }
  Tree describe(const Field& f, Box3& x) { return definition(f, "region", x); }
  Tree describe(const Field& f, Shape& x) { return definition(f, "shape", x); }
  template <class T>
  Tree describe(const Field& field, std::optional<T>&) {
    T inner{};
    return describe(field, inner);
  }
  template <class T>
  Tree describe(const Field& field, std::vector<T>&) {
    T item{};
    return {{"type", "array"}, {"items", definition(field, std::string(field.name) + "_item", item)}};
  }
  template <class E>
  requires std::is_enum_v<E> Tree describe(const Field&, E&) {
    Tree tree = Tree::array();
    for (const auto& [value, word] : words_of(E{})) tree.push_back(std::string(word));
    return words(tree);
  }
  template <class T>
  requires requires(Schema& v, T& x) { visit(v, x); }
  Tree describe(const Field& field, T& x) { return definition(field, std::string(field.name), x); }

  template <class T>
  Tree definition(const Field&, const std::string& name, T& x) {
    if (!definitions_.contains(name)) {
      definitions_[name] = nullptr;  // ends the recursion
      Tree object;
      Schema inner(definitions_, object);
      visit(inner, x);
      definitions_[name] = std::move(object);
    }
    return {{"$ref", "#/$defs/" + name}};
  }

  Tree& definitions_;
  Tree& object_;
  std::vector<std::string> options_;
  std::string only_for_;
  bool in_option_ = false;
};

Tree make_schema() {
  Tree definitions = Tree::object(), root;
  Scene scene;
  Schema visitor(definitions, root);
  visit(visitor, scene);
  Tree schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Ballast scene"}};
  schema.update(root);
  schema["$defs"] = std::move(definitions);
  return schema;
}

/// One line per key, indented by depth; follows references, once along each path.
void add_help(const Tree& schema, const Tree& object, int depth, std::vector<std::string> path, std::string& text) {
  for (const auto& [key, value] : object.at("properties").items()) {
    std::string line = fmt::format("{:{}}{}", "", depth * 2, key);
    std::string help = value.value("description", "");
    if (value.contains("enum")) {
      for (const Tree& word : value["enum"])
        help += (&word == &value["enum"][0] ? ": " : ", ") + word.get<std::string>();
    }
    if (value.contains("default"))
      help += fmt::format("{}default {}", help.empty() ? "" : "; ", value["default"].dump());
    const Tree required = object.value("required", Tree::array());
    if (std::find(required.begin(), required.end(), Tree(key)) != required.end())
      help += help.empty() ? "required" : "; required";
    text += fmt::format("{:<28}  {}\n", line, help);
    const Tree* inner = &value;
    if (inner->contains("items")) inner = &(*inner)["items"];
    auto below = path;
    if (inner->contains("$ref")) {
      const std::string name = (*inner)["$ref"].get<std::string>().substr(8);
      if (std::find(path.begin(), path.end(), name) != path.end()) continue;
      below.push_back(name);
      inner = &schema.at("$defs").at(name);
    }
    if (inner->contains("properties")) add_help(schema, *inner, depth + 1, below, text);
  }
}

}  // namespace
}  // namespace scene

std::string scene_schema() { return scene::make_schema().dump(2) + "\n"; }

std::string scene_help() {
  const scene::Tree schema = scene::make_schema();
  std::string text;
  scene::add_help(schema, schema, 0, {}, text);
  return text;
}

}  // namespace ballast
