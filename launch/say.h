// Printing for people, who may be gone: a closed terminal or pipe must not end a run. (fmt::print throws there.)
#pragma once
#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "common/result.h"

namespace ballast::launch {

template <class... Args>
void say(std::FILE* file, fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  std::fwrite(text.data(), 1, text.size(), file);
}

/// Says what went wrong; the exit code of the program.
inline int fail(const Error& error) {
  say(stderr, "ballast: {}\n", error.text());
  return error.exit_code;
}

}  // namespace ballast::launch
