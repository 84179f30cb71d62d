// Where messages go: LCM's own URLs, kept on this machine unless the user says otherwise.
#pragma once
#include <string>

#include "common/result.h"

namespace ballast::msgs {

/// The whole kernel buffer that Linux gives by default is lost in two bursts of particles; 4 MiB lost nothing.
inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";

/// What to open: `asked`, else the environment's LCM_DEFAULT_URL, else kDefaultUrl. Multicast without a ttl gets
/// ttl=0, so that nothing leaves the machine unasked. An error names a provider that LCM does not have.
Result<std::string> url_to_open(const std::string& asked);

}  // namespace ballast::msgs
