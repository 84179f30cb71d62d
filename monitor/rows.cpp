// Walks through the fields of a decoded message with the type information that lcm-gen writes for C.
#include "monitor/rows.h"

#include <fmt/format.h>
#include <lcm/lcm_coretypes.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>

#include "monitor/message_type.h"

namespace ballast::monitor {

namespace {

std::size_t size_of(const lcm_field_t& field) {
  if (field.type == LCM_FIELD_STRING) return sizeof(char*);
  if (const std::size_t bytes = wire_size(field.type); bytes > 0) return bytes;
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

}  // namespace

Result<Rows> rows_of(const void* data, std::size_t bytes) {
  if (bytes < 8)
    return Error{fmt::format("a message of {} bytes has no type", bytes), "is this a Ballast channel?", ""};
  const ballast_message_type_t* type = type_of(data, bytes);
  if (!type) {
    std::string hash;
    for (int k = 0; k < 8; ++k) hash += fmt::format("{:02x}", static_cast<const std::uint8_t*>(data)[k]);
    return Error{fmt::format("type {} is unknown", hash), "sender and monitor must come from the same build", ""};
  }
  auto message = std::make_unique<std::byte[]>(static_cast<std::size_t>(type->info->struct_size()));
  if (bytes > std::numeric_limits<int>::max() || !fits(*type->info, data, bytes) ||
      type->info->decode(data, 0, static_cast<int>(bytes), message.get()) < 0)
    return Error{fmt::format("a {} of {} bytes is damaged", type->name, bytes), "it was cut short on its way", ""};
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
