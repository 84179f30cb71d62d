// Completing and checking LCM URLs: provider://network?option=value&option=value.
#include "msgs/url.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace ballast::msgs {

namespace {

constexpr std::string_view kProviders[] = {"udpm", "tcpq", "memq", "file"};

bool has_option(std::string_view url, std::string_view name) {
  std::size_t at = url.find('?');
  while (at != std::string_view::npos) {
    const std::string_view option = url.substr(at + 1, url.find('&', at + 1) - at - 1);
    if (option.substr(0, option.find('=')) == name) return true;
    at = url.find('&', at + 1);
  }
  return false;
}

}  // namespace

Result<std::string> url_to_open(const std::string& asked) {
  std::string url = asked;
  const char* common = std::getenv("LCM_DEFAULT_URL");
  if (url.empty() && common != nullptr) url = common;
  if (url.empty()) return std::string(kDefaultUrl);
  const std::size_t end = url.find("://");
  const std::string_view provider = std::string_view(url).substr(0, end == std::string::npos ? 0 : end);
  if (std::ranges::find(kProviders, provider) == std::end(kProviders)) {
    return Error{"'" + url + "' is no LCM URL",
                 std::string("write provider://..., provider udpm, tcpq, memq or file, e.g. ") + kDefaultUrl,
                 asked.empty() ? "environment variable LCM_DEFAULT_URL" : "--lcm-url"};
  }
  if (provider == "udpm" && !has_option(url, "ttl")) url += url.find('?') == std::string::npos ? "?ttl=0" : "&ttl=0";
  return url;
}

}  // namespace ballast::msgs
