// Files of a checkpoint: each process writes the part that it knows, whole or not at all, with a checksum.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "common/result.h"

namespace ballast::checkpoint {

/// Raised whenever what is in the parts changes; other formats are refused.
inline constexpr std::uint32_t kFormat = 10;

/// Folder of the checkpoint after a step: OUT/checkpoints/STEP, twelve digits.
std::string folder_of(const std::string& out_dir, std::uint64_t step);
inline constexpr const char* kFolder = "checkpoints";
inline constexpr const char* kFluidPart = "fluid";
inline constexpr const char* kRigidPart = "rigid";
inline constexpr const char* kRunPart = "run";  ///< the coordinator's, written last: it names the others

/// How a part is told from another one of the same name.
struct Seal {
  std::uint64_t bytes = 0, hash = 0;
  bool operator==(const Seal&) const = default;
};

/// Writes folder/name: magic, format, CBOR of `state`, 64-bit FNV-1a of all that. Makes the folder.
Result<Seal> write_part(const std::string& folder, const std::string& name, const nlohmann::json& state);
/// Reads it back; a file that is missing, cut short, changed or of another format is an error that says which.
Result<nlohmann::json> read_part(const std::string& folder, const std::string& name, Seal* seal = nullptr);

/// Says when checkpoints are due: where simulated time crosses a multiple of the interval. Both processes ask at every
/// border of a step with the same time, so that they write at the same borders without talking about it.
class Due {
 public:
  /// `every` in s; 0: never. The run is at `time`.
  explicit Due(double every = 0, double time = 0) : every_(every), last_(number(time)) {}
  bool at(double time);

 private:
  std::int64_t number(double time) const;
  double every_;
  std::int64_t last_;
};

}  // namespace ballast::checkpoint
