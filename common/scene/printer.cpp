// The full effective scene as text: blocks down to the items of a list, one line for each of their values.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/scene/print_fields.h"
#include "common/scene/reader.h"

namespace ballast {
namespace scene {
namespace {

/// A word that YAML takes as it stands; everything else is quoted.
bool is_bare(const std::string& text) {
  if (text == "null" || text == "Null" || text == "NULL") return false;  // YAML would take it for nothing
  if (text.empty() || !(std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '/' || text[0] == '_'))
    return false;
  return text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./") ==
         std::string::npos;
}

std::string flow(const Tree& tree) {
  if (tree.is_number_float()) return fmt::format("{}", tree.get<double>());
  if (tree.is_string())
    return is_bare(tree.get<std::string>()) ? tree.get<std::string>()
                                            : tree.dump(-1, ' ', false, Tree::error_handler_t::replace);
  if (!tree.is_structured()) return tree.dump();
  std::string inside;
  for (const auto& [key, value] : tree.items()) {
    inside += (inside.empty() ? "" : ", ") + (tree.is_object() ? key + ": " : "") + flow(value);
  }
  if (tree.is_array()) return "[" + inside + "]";
  return inside.empty() ? "{}" : "{ " + inside + " }";
}

/// One line per key; `first` stands in front of the first one, `indent` in front of the others.
std::string lines(const Tree& map, std::string first, const std::string& indent) {
  std::string text;
  for (const auto& [key, value] : map.items()) {
    text += first + key + ": " + flow(value) + "\n";
    first = indent;
  }
  return text;
}

}  // namespace

Tree Printer::tree_of(const Axes& x) {
  Tree tree;
  for (size_t i = 0; i < 3; ++i) {
    if (x.on[i]) tree.push_back(std::string(1, "xyz"[i]));
  }
  return tree;
}

Tree Printer::tree_of(const Tolerance& x) {
  if (!x.relative) return tree_of(x.absolute);
  for (int digits = 3; digits <= 17; ++digits) {  // the shortest percentage that reads back to the same bits
    const std::string text = fmt::format("{:.{}g} %", *x.relative * 100, digits);
    const auto measure = parse_measure(text, kNone, 0);
    if (measure && measure->value == *x.relative) return text;
  }
  for (const double towards : {0.0, kNever}) {
    const std::string text = fmt::format("{} %", std::nextafter(*x.relative * 100, towards));
    const auto measure = parse_measure(text, kNone, 0);
    if (measure && measure->value == *x.relative) return text;
  }
  return fmt::format("{} %", *x.relative * 100);
}

}  // namespace scene

std::string print_scene(const Scene& original) {
  Scene copy = original;  // the lists of keys take members they could write to
  const scene::Tree tree = scene::Printer::tree_of(copy);
  std::string text;
  for (const auto& [key, value] : tree.items()) {
    if (value.is_object()) {
      text += key + ":\n" + scene::lines(value, "  ", "  ");
    } else if (value.is_array() && !value.empty()) {
      text += key + ":\n";
      for (const scene::Tree& item : value) text += scene::lines(item, "  - ", "    ");
    } else {
      text += key + ": " + scene::flow(value) + "\n";
    }
  }
  return text;
}

namespace scene {
namespace {

/// Lists of things with names become maps, so that one more model does not shift all that follow it.
nlohmann::json by_name(const nlohmann::json& tree) {
  nlohmann::json out = tree;
  if (tree.is_array()) {
    const bool named = !tree.empty() && std::ranges::all_of(tree, [](const auto& x) { return x.contains("name"); });
    if (named) out = nlohmann::json::object();
    for (std::size_t i = 0; i < tree.size(); ++i)
      (named ? out[tree[i]["name"].template get<std::string>()] : out[i]) = by_name(tree[i]);
  } else if (tree.is_object()) {
    for (const auto& [key, value] : tree.items()) out[key] = by_name(value);
  }
  return out;
}

}  // namespace
}  // namespace scene

std::vector<std::string> scene_differences(const Scene& a, const Scene& b) {
  const auto tree = [](Scene copy) {
    return scene::by_name(nlohmann::json::parse(scene::Printer::tree_of(copy).dump()));
  };
  std::vector<std::string> out;
  for (const auto& change : nlohmann::json::diff(tree(a), tree(b))) {
    const std::string path = change["path"].get<std::string>();
    if (std::ranges::find(out, path) == out.end()) out.push_back(path);
  }
  return out;
}

std::uint64_t scene_hash(const Scene& scene) {
  std::uint64_t hash = 14695981039346656037ull;  // FNV-1a, 64 bit
  for (const char c : print_scene(scene)) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return hash;
}

}  // namespace ballast
