// Types of messages, and whether bytes can be one.
#include "monitor/message_type.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

namespace ballast::monitor {

namespace {

constexpr std::size_t kHash = 8;

std::span<const ballast_message_type_t> types() {
  int count = 0;
  const ballast_message_type_t* first = ballast_message_types(&count);
  return {first, static_cast<std::size_t>(count)};
}

/// Goes along the bytes field by field and makes nothing of them. Every skip: false where they end too early.
struct Reader {
  const std::uint8_t* at;
  std::size_t left;

  bool skip(std::size_t bytes) {
    if (bytes > left) return false;
    at += bytes, left -= bytes;
    return true;
  }
  /// A whole number of 4 bytes, the first one the highest.
  bool whole(std::int32_t& out) {
    if (left < 4) return false;
    std::uint32_t value = 0;
    for (int k = 0; k < 4; ++k) value = value << 8 | at[k];
    out = static_cast<std::int32_t>(value);
    return skip(4);
  }
  /// Length with the zero at the end, text, zero.
  bool text() {
    std::int32_t length = 0;
    if (!whole(length) || length < 1) return false;
    const std::uint8_t* first = at;
    return skip(static_cast<std::size_t>(length)) && first[length - 1] == 0;
  }
  bool elements(const lcm_field_t& field, std::size_t count) {
    if (const std::size_t size = wire_size(field.type); size > 0) return count <= left / size && skip(count * size);
    const lcm_type_info_t* type = field.type == LCM_FIELD_STRING ? nullptr : type_of_name(field.typestr);
    if (field.type != LCM_FIELD_STRING && !type) return false;
    // Each has at least one byte, so that this ends with the bytes whatever the count says.
    for (std::size_t i = 0; i < count; ++i)
      if (left == 0 || !(type ? structure(*type) : text())) return false;
    return true;
  }
  bool structure(const lcm_type_info_t& type) {
    const std::vector<std::byte> zeros(static_cast<std::size_t>(type.struct_size()));  // get_field() looks into one
    std::int32_t count = -1;
    for (int i = 0; i < type.num_fields(); ++i) {
      lcm_field_t field{};
      type.get_field(zeros.data(), i, &field);
      if (field.num_dim == 0 && field.type == LCM_FIELD_INT32_T && std::strcmp(field.name, "count") == 0) {
        if (!whole(count)) return false;
        continue;
      }
      std::size_t n = 1;
      for (int d = 0; d < field.num_dim; ++d) {
        if (field.dim_is_variable[d] && count < 0) return false;
        n *= static_cast<std::size_t>(field.dim_is_variable[d] ? count : field.dim_size[d]);
      }
      if (!elements(field, n)) return false;
    }
    return true;
  }
};

}  // namespace

std::size_t wire_size(lcm_field_type_t type) {
  switch (type) {
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
    case LCM_FIELD_USER_TYPE:
      break;
  }
  return 0;
}

const ballast_message_type_t* type_of(const void* data, std::size_t bytes) {
  if (bytes < kHash) return nullptr;
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i < kHash; ++i) hash = hash << 8 | static_cast<const std::uint8_t*>(data)[i];
  const auto found = std::ranges::find_if(
      types(), [&](const auto& t) { return t.info->get_hash() == static_cast<std::int64_t>(hash); });
  return found == types().end() ? nullptr : &*found;
}

const lcm_type_info_t* type_of_name(const char* name) {
  const char* dot = std::strrchr(name, '.');
  const auto found =
      std::ranges::find_if(types(), [&](const auto& t) { return std::strcmp(t.name, dot ? dot + 1 : name) == 0; });
  return found == types().end() ? nullptr : found->info;
}

bool fits(const lcm_type_info_t& type, const void* data, std::size_t bytes) {
  Reader reader{static_cast<const std::uint8_t*>(data), bytes};
  return reader.skip(kHash) && reader.structure(type) && reader.left == 0;
}

}  // namespace ballast::monitor
