/* All message types of this folder with what lcm-gen knows about their fields; the list is made by CMake. */
#ifndef BALLAST_MSGS_TYPES_H
#define BALLAST_MSGS_TYPES_H

#ifdef __cplusplus
extern "C" {
#endif

struct _lcm_type_info_t; /* LCM's name for it; its header is for those who look inside */

/* One type: its name as in the .lcm file, and how to decode it and walk through its fields. */
typedef struct {
  const char* name;
  const struct _lcm_type_info_t* info;
} ballast_message_type_t;

/* All types; *count says how many. */
const ballast_message_type_t* ballast_message_types(int* count);

#ifdef __cplusplus
}
#endif
#endif
