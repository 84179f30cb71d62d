// Visitor that lists the keys of one map and which of them exclude each other, without reading anything.
#pragma once
#include <string>
#include <vector>

#include "common/scene/field.h"

namespace ballast::scene {

class Keys {
 public:
  static constexpr bool kReads = false, kPrints = false;

  template <class T>
  void operator()(const Field& field, T&&) {
    all.emplace_back(field.name);
  }
  template <class List>
  void group(const Field& field, List&&) {
    all.emplace_back(field.name);
  }
  template <class Form, class Code, class T>
  void option(const Field& field, Form, const Code&, T&&) {
    all.emplace_back(field.name);
    options.emplace_back(field.name);
  }
  template <class Form, class Code, class List>
  void option_group(const Field& field, Form, const Code&, List&&) {
    all.emplace_back(field.name);
    options.emplace_back(field.name);
  }
  template <class Form, class Code>
  void flag(const Field& field, Form, const Code&) {
    all.emplace_back(field.name);
    options.emplace_back(field.name);
  }
  void needs_option(std::string_view what) { needed = what; }
  void either(const Field& a, double&, const Field& b, double&) {
    all.insert(all.end(), {std::string(a.name), std::string(b.name)});
    pairs.push_back({std::string(a.name), std::string(b.name)});
  }
  template <class List>
  void when(bool, std::string_view, List&& list) {
    list(*this);
  }

  std::vector<std::string> all;                 ///< every key that the map may have
  std::vector<std::string> options;             ///< of these at most one
  std::vector<std::vector<std::string>> pairs;  ///< of each of these at most one
  std::string needed;                           ///< what an option says, where one has to be there
};

}  // namespace ballast::scene
