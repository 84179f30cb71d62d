// One list of members per class writes its part of a checkpoint and reads it back: `template <class A> void state(A&
// a)` calls a("name", member) for each member that the next step depends on. Values become JSON, arrays of plain
// records binary strings in it; part.h makes CBOR of that.
#pragma once
#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "common/result.h"

namespace ballast::checkpoint {

using Json = nlohmann::json;

class StateWriter;
class StateReader;

namespace detail {

/// Copied byte by byte: plain records, and Eigen's vectors and matrices of fixed size.
template <class T>
concept Raw = std::is_trivially_copyable_v<T> || requires {
  typename T::Scalar;
  requires T::SizeAtCompileTime >
  0;
};
template <class T>
concept Number = std::is_arithmetic_v<T>;
template <class T>
concept Listed = requires(T& x, StateWriter& w) {
  x.state(w);
};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

}  // namespace detail

class StateWriter {
 public:
  template <class T>
  void operator()(const char* name, T& value) {
    out_[name] = packed(value);
  }
  Json take() { return std::move(out_); }

 private:
  static Json bytes(const void* data, std::size_t size) {
    const auto* from = static_cast<const std::uint8_t*>(data);
    return Json::binary(std::vector<std::uint8_t>(from, from + size));
  }
  template <class T>
  static Json packed(T& value) {
    if constexpr (detail::Number<T> || std::is_same_v<T, std::string> || std::is_same_v<T, Json>) {
      return value;
    } else if constexpr (detail::Listed<T>) {
      StateWriter inner;
      value.state(inner);
      return inner.take();
    } else if constexpr (detail::Raw<T>) {
      return bytes(&value, sizeof value);
    } else if constexpr (detail::IsVector<T>::value) {
      using Item = typename T::value_type;
      if constexpr (detail::Raw<Item>) return bytes(value.data(), value.size() * sizeof(Item));
      Json list = Json::array();
      if constexpr (!detail::Raw<Item>)
        for (Item& item : value) list.push_back(packed(item));
      return list;
    } else {
      static_assert(detail::Raw<T>, "give this type a list of its members: template <class A> void state(A& a)");
    }
  }
  Json out_ = Json::object();
};

/// Keeps the first thing that does not fit, and leaves all later members as they were.
class StateReader {
 public:
  explicit StateReader(const Json& in) : in_(in) {}
  template <class T>
  void operator()(const char* name, T& value) {
    if (!fault_.empty()) return;
    const auto found = in_.is_object() ? in_.find(name) : in_.end();
    if (found == in_.end()) {
      fault_ = fmt::format("it has no '{}'", name);
    } else if (!unpack(*found, value)) {
      if (fault_.empty()) fault_ = fmt::format("its '{}' has another type or size", name);
    }
  }
  /// An error of bad input if anything did not fit.
  Status status() const {
    if (fault_.empty()) return ok();
    return Error{"the checkpoint cannot be used: " + fault_, "it was written by another version of Ballast: start anew",
                 ""};
  }

 private:
  template <class T>
  bool unpack(const Json& from, T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      return from.is_boolean() && (value = from.get<bool>(), true);
    } else if constexpr (detail::Number<T>) {
      return from.is_number() && (value = from.get<T>(), true);
    } else if constexpr (std::is_same_v<T, std::string>) {
      return from.is_string() && (value = from.get<std::string>(), true);
    } else if constexpr (std::is_same_v<T, Json>) {
      value = from;
      return true;
    } else if constexpr (detail::Listed<T>) {
      StateReader inner(from);
      value.state(inner);
      fault_ = inner.fault_;
      return fault_.empty();
    } else if constexpr (detail::Raw<T>) {
      if (!from.is_binary() || from.get_binary().size() != sizeof value) return false;
      std::memcpy(static_cast<void*>(&value), from.get_binary().data(), sizeof value);
      return true;
    } else {
      return unpack_list(from, value);
    }
  }
  template <class Item>
  bool unpack_list(const Json& from, std::vector<Item>& value) {
    if constexpr (detail::Raw<Item>) {
      if (!from.is_binary() || from.get_binary().size() % sizeof(Item) != 0) return false;
      value.resize(from.get_binary().size() / sizeof(Item));
      if (!value.empty())
        std::memcpy(static_cast<void*>(value.data()), from.get_binary().data(), from.get_binary().size());
      return true;
    } else {
      if (!from.is_array()) return false;
      value.resize(from.size());
      for (std::size_t i = 0; i < value.size(); ++i)
        if (!unpack(from[i], value[i])) return false;
      return true;
    }
  }
  const Json& in_;
  std::string fault_;
};

template <class T>
Json save(T& object) {
  StateWriter writer;
  object.state(writer);
  return writer.take();
}
template <class T>
Status restore(const Json& from, T& object) {
  StateReader reader(from);
  object.state(reader);
  return reader.status();
}

}  // namespace ballast::checkpoint
