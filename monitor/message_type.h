// Types of messages by what lcm-gen knows about them, and whether bytes can be one: the generated decoders trust every
// length that a message carries.
#pragma once
#include <lcm/lcm_coretypes.h>

#include <cstddef>
#include <cstdint>

#include "msgs/types.h"

namespace ballast::monitor {

/// The type whose hash the message begins with; nullptr: none of ours, or fewer than eight bytes.
const ballast_message_type_t* type_of(const void* data, std::size_t bytes);

/// The type of a field, which names it without its package; nullptr: none of ours.
const struct _lcm_type_info_t* type_of_name(const char* name);

/// Bytes of one element of a field as it is sent; 0: texts and structs, which have lengths of their own.
std::size_t wire_size(lcm_field_type_t type);

/// True if a message of this type could be decoded from these bytes: every text ends with its zero within them, lists
/// (their length is the field `count` before them) are whole, and nothing follows. Allocates a few hundred bytes.
bool fits(const struct _lcm_type_info_t& type, const void* data, std::size_t bytes);

}  // namespace ballast::monitor
