// The visitor that fills structs from maps: unknown, unused, missing and conflicting keys are errors.
#pragma once
#include <set>
#include <type_traits>

#include "common/scene/fields.h"
#include "common/scene/keys.h"
#include "common/scene/read_value.h"

namespace ballast::scene {

class Reader {
 public:
  static constexpr bool kReads = true, kPrints = false;
  Reader(ReadState& state, const Node& map) : state_(state), map_(map) {}

  /// Refuses unknown keys and decides between keys that exclude each other: the later override wins, else an error.
  bool admit(const Keys& keys);

  ReadState& state() { return state_; }

  template <class T>
  void operator()(const Field& field, T&& target) {
    if (state_.error) return;
    const Entry* entry = take(field.name);
    if (entry != nullptr) {
      read(field, entry->value, std::forward<T>(target));
    } else if (field.required) {
      missing(field);
    }
  }

  template <class List>
  void group(const Field& field, List&& list) {
    const Entry* entry = take(field.name);
    if (entry != nullptr && !state_.error) read_map(state_, field, entry->value, list);
  }

  template <class Form, class Code, class T>
  void option(const Field& field, Form form, const Code& code, T&& target) {
    if (take(field.name) == nullptr) return;
    form = code;
    (*this)(field, std::forward<T>(target));
  }

  template <class Form, class Code, class List>
  void option_group(const Field& field, Form form, const Code& code, List&& list) {
    if (take(field.name) == nullptr) return;
    form = code;
    group(field, list);
  }

  template <class Form, class Code>
  void flag(const Field& field, Form form, const Code& code) {
    bool on = false;
    (*this)(field, on);
    if (on) form = code;
  }

  void needs_option(std::string_view) {}  // admit() has seen to it

  void either(const Field& a, double& x, const Field& b, double& y) {
    (*this)(a, x);
    (*this)(b, y);
  }

  template <class List>
  void when(bool condition, std::string_view whose, List&& list) {
    if (condition) return list(*this);
    Keys keys;
    list(keys);
    for (const std::string& key : keys.all) refuse(key, whose);
  }

  /// Reads a map with the keys of `list`.
  template <class List>
  static void read_map(ReadState& state, const Field& field, const Node& node, List&& list) {
    if (!is_kind(state, field, node, Node::Kind::kMap)) return;
    Keys keys;
    list(keys);
    Reader reader(state, node);
    if (reader.admit(keys)) list(reader);
  }

 private:
  /// The entry of a key, nullptr where absent or overruled; remembers its place.
  const Entry* take(std::string_view key);
  void missing(const Field& field);
  void refuse(const std::string& key, std::string_view whose);

  template <class T>
  void read(const Field& field, const Node& node, T&& target) {
    if constexpr (requires { read_value(state_, field, node, std::forward<T>(target)); }) {
      read_value(state_, field, node, std::forward<T>(target));
    } else {
      read_structure(field, node, target);
    }
  }

  template <class T>
  void read_structure(const Field& field, const Node& node, T& target) {
    if constexpr (requires { target.place; }) target.place = node.place;
    if constexpr (requires { target.given; }) target.given = true;
    read_map(state_, field, node, [&](auto& v) { visit(v, target); });
  }

  void read_structure(const Field& field, const Node& node, Pose& target) {
    if (node.kind == Node::Kind::kList) return read_pose_list(state_, node, target);
    read_map(state_, field, node, [&](auto& v) { visit(v, target); });
  }

  template <class T>
  void read_structure(const Field& field, const Node& node, std::optional<T>& target) {
    read_structure(field, node, target.emplace());
  }

  template <class T>
  void read_structure(const Field& field, const Node& node, std::vector<T>& target) {
    if (!is_kind(state_, field, node, Node::Kind::kList)) return;
    for (const Node& item : node.list) {
      if (state_.error) return;
      read_structure(field, item, target.emplace_back());
    }
  }

  template <class E>
  requires std::is_enum_v<E>
  void read_structure(const Field& field, const Node& node, E& target) {
    std::vector<std::string> words;
    for (const auto& [value, word] : words_of(E{})) words.emplace_back(word);
    if (const auto index = read_word(state_, field, node, words)) target = words_of(E{})[*index].first;
  }

  ReadState& state_;
  const Node& map_;
  std::set<std::string, std::less<>> overruled_;
};

}  // namespace ballast::scene
