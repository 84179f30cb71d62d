// The visitor that turns structs into an ordered tree of keys and values, as they would be written in a scene file.
#pragma once
#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <vector>

#include "common/scene/fields.h"

namespace ballast::scene {

using Tree = nlohmann::ordered_json;

/// From here on a time means "never"; such defaults are not written.
inline constexpr double kNever = 1e300;

class Printer {
 public:
  static constexpr bool kReads = false, kPrints = true;
  explicit Printer(Tree& out) : out_(out) {}

  /// A value that says nothing (empty text or list, absent number) becomes null and is not written.
  template <class T>
  void operator()(const Field& field, T&& value) {
    Tree tree = tree_of(value);
    if (!tree.is_null()) out_[std::string(field.name)] = std::move(tree);
  }
  template <class List>
  void group(const Field& field, List&& list) {
    Tree inner = Tree::object();
    Printer printer(inner);
    list(printer);
    if (!inner.empty()) out_[std::string(field.name)] = std::move(inner);
  }
  template <class Form, class Code, class T>
  void option(const Field& field, Form form, const Code& code, T&& value) {
    if (form == code) (*this)(field, value);
  }
  template <class Form, class Code, class List>
  void option_group(const Field& field, Form form, const Code& code, List&& list) {
    if (form != code) return;
    out_[std::string(field.name)] = Tree::object();  // there even if all its values are left out
    group(field, list);
  }
  template <class Form, class Code>
  void flag(const Field& field, Form form, const Code& code) {
    if (form == code) out_[std::string(field.name)] = true;
  }
  void needs_option(std::string_view) {}
  void either(const Field& a, double x, const Field& b, double y) {
    if (x != 0) (*this)(a, x);
    if (y != 0) (*this)(b, y);
  }
  template <class List>
  void when(bool condition, std::string_view, List&& list) {
    if (condition) list(*this);
  }

  static Tree tree_of(double x) { return x >= kNever ? Tree() : Tree(x == 0 ? 0.0 : x); }
  static Tree tree_of(int x) { return x; }
  static Tree tree_of(std::uint64_t x) { return x; }
  static Tree tree_of(bool x) { return x; }
  static Tree tree_of(const std::string& x) { return x.empty() ? Tree() : Tree(x); }
  static Tree tree_of(const Vec3& x) { return list({x.x(), x.y(), x.z()}); }
  static Tree tree_of(const Quat& q) { return list({q.w(), q.x(), q.y(), q.z()}); }
  static Tree tree_of(const std::optional<double>& x) { return x ? tree_of(*x) : Tree(); }
  static Tree tree_of(const std::array<int, 3>& x) { return Tree(x); }
  static Tree tree_of(const Name& x) { return tree_of(x.text); }
  static Tree tree_of(const MeshFile& x) { return tree_of(x.path); }
  static Tree tree_of(const Axis& x) { return tree_of(x.vector); }
  static Tree tree_of(const Factors& x) { return tree_of(x.vector); }
  static Tree tree_of(const Ground& x) { return list({x.point.x(), x.point.y()}); }
  static Tree tree_of(const MostLost& x) { return x.share ? tree_of(Tolerance{x.count, x.share}) : Tree(0); }
  static Tree tree_of(const Axes& x);
  static Tree tree_of(const Tolerance& x);
  static Tree tree_of(Pose& pose) {
    return pose.rotation.coeffs() == Quat::Identity().coeffs() ? tree_of(pose.position) : tree_of_struct(pose);
  }
  template <class E>
  requires std::is_enum_v<E>
  static Tree tree_of(const E& x) {
    for (const auto& [value, word] : words_of(E{})) {
      if (value == x) return std::string(word);
    }
    return {};
  }
  template <class T>
  static Tree tree_of(std::optional<T>& x) {
    return x ? tree_of(*x) : Tree();
  }
  template <class T>
  static Tree tree_of(std::vector<T>& items) {
    Tree tree;
    for (T& item : items) tree.push_back(tree_of(item));
    return tree;
  }
  template <class T>
  requires requires(Printer& v, T& x) { visit(v, x); }
  static Tree tree_of(T& x) { return tree_of_struct(x); }

 private:
  static Tree list(std::initializer_list<double> numbers) {
    Tree tree = Tree::array();
    for (const double x : numbers) tree.push_back(x == 0 ? 0.0 : x);  // -0 and 0 are one value to a reader
    return tree;
  }
  template <class T>
  static Tree tree_of_struct(T& x) {
    Tree tree = Tree::object();
    Printer printer(tree);
    visit(printer, x);
    return tree;
  }

  Tree& out_;
};

}  // namespace ballast::scene
