// Walks through the fields of a decoded message with the type information that lcm-gen writes for C.
#include "monitor/rows.h"

#include <fmt/format.h>
#include <lcm/lcm_coretypes.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <span>

#include "msgs/types.h"

namespace ballast::monitor {

namespace {

std::span<const ballast_message_type_t> types() {
  int count = 0;
  const ballast_message_type_t* first = ballast_message_types(&count);
  return {first, static_cast<std::size_t>(count)};
}

const ballast_message_type_t* type_of_hash(std::int64_t hash) {
  const auto found = std::ranges::find_if(types(), [&](const auto& t) { return t.info->get_hash() == hash; });
  return found == types().end() ? nullptr : &*found;
}

/// Types of fields are named without their package.
const lcm_type_info_t* type_of_name(const char* name) {
  const char* dot = std::strrchr(name, '.');
  const auto found =
      std::ranges::find_if(types(), [&](const auto& t) { return std::strcmp(t.name, dot ? dot + 1 : name) == 0; });
  return found == types().end() ? nullptr : found->info;
}

std::size_t size_of(const lcm_field_t& field) {
  switch (field.type) {
    case LCM_FIELD_INT8_T:
    case LCM_FIELD_BYTE:
    case LCM_FIELD_BOOLEAN:
      return 1;
    case LCM_FIELD_INT16_T:
      return 2;
    case LCM_FIELD_INT32_T:
    case LCM_FIELD_FLOAT:
      return 4;
    case LCM_FIELD_INT64_T:
    case LCM_FIELD_DOUBLE:
      return 8;
    case LCM_FIELD_STRING:
      return sizeof(char*);
    case LCM_FIELD_USER_TYPE:
      break;
  }
  const lcm_type_info_t* info = type_of_name(field.typestr);
  return info ? static_cast<std::size_t>(info->struct_size()) : 0;
}

template <class T>
T get(const void* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

std::string word(const lcm_field_t& field, const void* at) {
  switch (field.type) {
    case LCM_FIELD_INT8_T:
      return fmt::format("{}", int{get<std::int8_t>(at)});
    case LCM_FIELD_INT16_T:
      return fmt::format("{}", get<std::int16_t>(at));
    case LCM_FIELD_INT32_T:
      return fmt::format("{}", get<std::int32_t>(at));
    case LCM_FIELD_INT64_T:
      return fmt::format("{}", get<std::int64_t>(at));
    case LCM_FIELD_BYTE:
    case LCM_FIELD_BOOLEAN:
      return fmt::format("{}", int{get<std::uint8_t>(at)});
    case LCM_FIELD_FLOAT:
      return fmt::format("{}", get<float>(at));  // the fewest digits that give the same number back
    case LCM_FIELD_DOUBLE:
      return fmt::format("{}", get<double>(at));
    case LCM_FIELD_STRING:
      return get<const char*>(at);
    case LCM_FIELD_USER_TYPE:
      break;
  }
  return "";
}

std::string index_name(std::int32_t size, std::int32_t i) {
  if (size == 3) return std::string(1, "xyz"[i]);
  if (size == 4) return std::string(1, "wxyz"[i]);  // quaternions
  return std::to_string(i);
}

/// Collects names or words of one row; list entry `entry` where the walk meets a list.
struct Walk {
  bool names;  // or values
  std::int32_t entry;
  std::vector<std::string> out;

  void add(const std::string& prefix, const lcm_field_t& field, const void* at) {
    if (field.type == LCM_FIELD_USER_TYPE) {
      if (const lcm_type_info_t* info = type_of_name(field.typestr)) type(prefix + ".", *info, at);
    } else {
      out.push_back(names ? prefix : word(field, at));
    }
  }

  void type(const std::string& prefix, const lcm_type_info_t& info, const void* message) {
    for (int i = 0; i < info.num_fields(); ++i) {
      lcm_field_t field{};
      info.get_field(message, i, &field);
      const std::string name = prefix + field.name;
      if (field.num_dim == 0) {
        add(name, field, field.data);
      } else if (field.dim_is_variable[0]) {
        const char* first = get<const char*>(field.data);  // a list is a pointer in the struct
        add(name, field, first + static_cast<std::size_t>(entry) * size_of(field));
      } else {
        for (std::int32_t k = 0; k < field.dim_size[0]; ++k) {
          add(name + "." + index_name(field.dim_size[0], k), field,
              static_cast<const char*>(field.data) + static_cast<std::size_t>(k) * size_of(field));
        }
      }
    }
  }
};

/// Entries of the message's lists; -1 where it has none.
std::int32_t list_size(const lcm_type_info_t& info, const void* message) {
  for (int i = 0; i < info.num_fields(); ++i) {
    lcm_field_t field{};
    info.get_field(message, i, &field);
    if (field.num_dim > 0 && field.dim_is_variable[0]) return field.dim_size[0];
  }
  return -1;
}

std::int64_t first_eight_bytes(const void* data) {
  std::uint64_t hash = 0;
  for (int i = 0; i < 8; ++i) hash = hash << 8 | static_cast<const std::uint8_t*>(data)[i];
  return static_cast<std::int64_t>(hash);
}

}  // namespace

Result<Rows> rows_of(const void* data, std::size_t bytes) {
  if (bytes < 8)
    return Error{fmt::format("a message of {} bytes has no type", bytes), "is this a Ballast channel?", ""};
  const ballast_message_type_t* type = type_of_hash(first_eight_bytes(data));
  if (!type) {
    return Error{fmt::format("type {:016x} is unknown", static_cast<std::uint64_t>(first_eight_bytes(data))),
                 "sender and monitor must come from the same build", ""};
  }
  // Zeros first: a decoder that gives up half-way leaves the rest as it was.
  auto message = std::make_unique<std::byte[]>(static_cast<std::size_t>(type->info->struct_size()));
  const int length = static_cast<int>(std::min<std::size_t>(bytes, std::numeric_limits<int>::max()));
  if (type->info->decode(data, 0, length, message.get()) < 0) {
    // Entries of a list may hold anything where the decoder gave up, so those few bytes are lost rather than freed.
    if (list_size(*type->info, message.get()) < 0) type->info->decode_cleanup(message.get());
    return Error{fmt::format("a {} of {} bytes is damaged", type->name, bytes), "it was cut short on its way", ""};
  }
  Rows out{type->name, {}, {}};
  const std::int32_t entries = list_size(*type->info, message.get());
  if (entries != 0) {
    Walk names{true, 0, {}};
    names.type("", *type->info, message.get());
    out.columns = std::move(names.out);
  }
  for (std::int32_t i = 0; i < std::max(entries, entries < 0 ? 1 : 0); ++i) {
    Walk row{false, i, {}};
    row.type("", *type->info, message.get());
    out.rows.push_back(std::move(row.out));
  }
  type->info->decode_cleanup(message.get());
  return out;
}

std::string csv_line(const std::vector<std::string>& words) {
  std::string line;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) line += ',';
    if (words[i].find_first_of(",\"\r\n") == std::string::npos) {
      line += words[i];
      continue;
    }
    line += '"';
    for (char c : words[i]) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line;
}

}  // namespace ballast::monitor
