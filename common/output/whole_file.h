// Files that are whole or not there: written under a temporary name and renamed when complete.
#pragma once
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>

#include "common/result.h"

namespace ballast::output {

/// Writes `content` to `path` through `path`.part; exit code 2 where the folder cannot be written to.
inline Status write_whole(const std::string& path, std::string_view content) {
  const std::string part = path + ".part";
  {
    std::ofstream file(part, std::ios::binary | std::ios::trunc);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    if (!file.flush()) {
      std::remove(part.c_str());
      return Error{"cannot write " + path,
                   "check that the folder exists, may be written to, and that the disk is not full", ""};
    }
  }
  if (std::rename(part.c_str(), path.c_str()) != 0) {
    return Error{"cannot rename " + part + " to " + path, "check the permissions of the folder", ""};
  }
  return ok();
}

}  // namespace ballast::output
