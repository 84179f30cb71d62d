// Files that are whole or not there: written under a temporary name and renamed when complete.
#pragma once
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>
#include <string_view>

#include "common/result.h"

namespace ballast::output {

/// The error of a file that cannot be written, by errno: 5 where the disk is full or fails, 2 where the folder is the
/// wrong one.
inline Error write_error(const std::string& path, int reason) {
  const bool disk = reason == ENOSPC || reason == EDQUOT || reason == EIO || reason == EFBIG;
  return {"cannot write " + path + ": " + (reason != 0 ? std::strerror(reason) : "unknown reason"),
          disk ? "make room on that disk (df -h), or choose a folder on another one with --out"
               : "check that the folder exists and may be written to, or choose another one with --out",
          "", disk ? kProcessFailed : kBadInput};
}

/// Writes `content` to `path` through `path`.part.
inline Status write_whole(const std::string& path, std::string_view content) {
  const std::string part = path + ".part";
  errno = 0;
  {
    std::ofstream file(part, std::ios::binary | std::ios::trunc);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    if (!file.flush()) {
      const int reason = errno;
      std::remove(part.c_str());
      return write_error(path, reason);
    }
  }
  if (std::rename(part.c_str(), path.c_str()) != 0) return write_error(path, errno);
  return ok();
}

}  // namespace ballast::output
