// Writing and reading of one part: nlohmann's CBOR between a magic number and a checksum.
#include "common/checkpoint/part.h"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/exchange/hash.h"
#include "common/intervals.h"
#include "common/output/whole_file.h"

namespace ballast::checkpoint {

namespace {

constexpr char kMagic[8] = {'\n', 'B', 'A', 'L', 'C', 'K', 'P', 'T'};
constexpr std::size_t kHead = sizeof kMagic + sizeof(std::uint32_t), kTail = sizeof(std::uint64_t);

std::uint64_t hash_of(const void* data, std::size_t bytes) {
  exchange::Hash hash;
  hash.add(data, bytes);
  return hash.value();
}

Error refused(const std::string& path, const std::string& what) {
  return {path + ": " + what, "resume from an earlier checkpoint, or start the run anew", ""};
}

}  // namespace

std::string folder_of(const std::string& out_dir, std::uint64_t step) {
  return fmt::format("{}/{}/{:012}", out_dir, kFolder, step);
}

Result<Seal> write_part(const std::string& folder, const std::string& name, const nlohmann::json& state) {
  std::string text(kHead, '\0');
  std::memcpy(text.data(), kMagic, sizeof kMagic);
  std::memcpy(text.data() + sizeof kMagic, &kFormat, sizeof kFormat);
  nlohmann::json::to_cbor(state, text);
  const std::uint64_t hash = hash_of(text.data(), text.size());
  text.append(reinterpret_cast<const char*>(&hash), sizeof hash);
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (auto written = output::write_whole(folder + "/" + name, text); !written) {
    Error error = written.error();
    error.exit_code = kProcessFailed;  // in mid-run: not the scene's fault
    return error;
  }
  return Seal{text.size(), hash};
}

Result<nlohmann::json> read_part(const std::string& folder, const std::string& name, Seal* seal) {
  const std::string path = folder + "/" + name;
  std::ifstream file(path, std::ios::binary);
  if (!file) return refused(path, "this part of the checkpoint is missing or cannot be read");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.size() < kHead + kTail || std::memcmp(text.data(), kMagic, sizeof kMagic) != 0)
    return refused(path, fmt::format("this is no part of a checkpoint, or was cut short ({} bytes)", text.size()));
  std::uint32_t format = 0;
  std::memcpy(&format, text.data() + sizeof kMagic, sizeof format);
  if (format != kFormat)
    return refused(path,
                   fmt::format("the checkpoint has format {}, this version of Ballast reads {}", format, kFormat));
  std::uint64_t hash = 0;
  std::memcpy(&hash, text.data() + text.size() - kTail, sizeof hash);
  if (hash != hash_of(text.data(), text.size() - kTail))
    return refused(path, "its checksum is wrong: it was cut short or changed");
  nlohmann::json state =
      nlohmann::json::from_cbor(text.begin() + kHead, text.end() - static_cast<std::ptrdiff_t>(kTail), true, false);
  if (!state.is_object()) return refused(path, "its content cannot be read");
  if (seal) *seal = {text.size(), hash};
  return state;
}

std::int64_t Due::number(double time) const { return every_ > 0 ? intervals_passed(time, every_) : 0; }

bool Due::at(double time) {
  const std::int64_t now = number(time);
  if (now <= last_) return false;
  last_ = now;
  return true;
}

}  // namespace ballast::checkpoint
