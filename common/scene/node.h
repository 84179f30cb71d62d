// A YAML document as a plain tree in which every key and value knows its place; overrides change it before it is read.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "common/scene/reader.h"
#include "common/scene/scene.h"

namespace ballast::scene {

struct Entry;

struct Node {
  enum class Kind { kNothing, kText, kList, kMap };
  Kind kind = Kind::kNothing;
  std::string text;
  std::vector<Node> list;
  std::vector<Entry> map;  ///< in the file's order, no key twice
  Place place;

  const Entry* find(std::string_view key) const;
  Entry* find(std::string_view key);
};

struct Entry {
  std::string key;
  Place place;
  int rank = 0;  ///< 0: from the file; n: from the n-th override, which beats lower ranks where keys exclude each other
  Node value;
};

/// "file:line:column", or only the file where there is no line ("--set path").
std::string where(const Place& place);

/// An error at a place.
Error error_at(const Place& place, std::string what, std::string cure);

/// Parses one YAML document; syntax errors, duplicate keys and keys that are not plain text carry their place.
Result<Node> parse_yaml(const std::string& text, const std::string& file);

/// Applies `path=value` to the tree. Steps of the path are keys, names of list items (their `name`) or indices from 0.
/// Keys that are absent are added; whether they are allowed is for the reader to say.
Status apply_overrides(Node& root, const Overrides& overrides);

}  // namespace ballast::scene
