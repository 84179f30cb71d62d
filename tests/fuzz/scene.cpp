// Any text is a scene or an error with words; a scene that is printed and read again is the same scene.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/scene/reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto scene = ballast::read_scene_text(text, "fuzz.yaml");
  if (!scene) {
    if (scene.error().what.empty() || scene.error().cure.empty() || scene.error().exit_code != 2) std::abort();
    return 0;
  }
  if (scene->models.size() > 100) return 0;  // slow, and the same
  const std::string printed = ballast::print_scene(*scene);
  const auto again = ballast::read_scene_text(printed, "fuzz.yaml");
  if (!again || ballast::print_scene(*again) != printed) std::abort();
  return 0;
}
