// Any bytes on any channel are a message or none: for the table of `ballast tap` and the screen of `ballast watch`.

#include <cstdint>
#include <cstring>
#include <vector>

#include "monitor/message_type.h"
#include "monitor/rows.h"
#include "monitor/screen.h"
#include "msgs/channels.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  // The first byte chooses the type, whose hash nobody would guess.
  int count = 0;
  const ballast_message_type_t* types = ballast_message_types(&count);
  const lcm_type_info_t* info = types[data[0] % count].info;
  std::vector<std::uint8_t> bytes(data, data + size);
  bytes.insert(bytes.begin(), 7, 0);
  const auto hash = static_cast<std::uint64_t>(info->get_hash());
  for (std::size_t k = 0; k < 8; ++k) bytes[k] = static_cast<std::uint8_t>(hash >> (56 - 8 * k));
  (void)ballast::monitor::rows_of(bytes.data(), bytes.size());
  static ballast::monitor::View view;
  for (const char* channel : {ballast::msgs::kStatus, ballast::msgs::kFluid, ballast::msgs::kBodies,
                              ballast::msgs::kWrenches, ballast::msgs::kContacts, ballast::msgs::kParticles})
    view.take(channel, bytes.data(), bytes.size());
  return 0;
}
