// Printing for people, who may be gone: a closed terminal or pipe must not end a run. (fmt::print throws there.)
#pragma once
#include <fmt/format.h>

#include <cstdio>
#include <string>

namespace ballast::launch {

template <class... Args>
void say(std::FILE* file, fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  std::fwrite(text.data(), 1, text.size(), file);
}

}  // namespace ballast::launch
