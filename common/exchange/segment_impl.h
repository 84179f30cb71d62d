// What a mapped segment consists of; shared by the files of this folder only.
#pragma once
#include <sys/stat.h>

#include <boost/interprocess/mapped_region.hpp>
#include <boost/interprocess/shared_memory_object.hpp>

#include "common/exchange/layout.h"

namespace ballast::exchange {

/// Longest sleep without a look at the other processes. Promised are 100 ms; half of it leaves room for scheduling.
inline constexpr std::chrono::milliseconds kSlice{50};

struct Segment::Impl {
  std::string name;
  std::string path;  ///< of a segment without a name, for others to attach; empty where it has one
  boost::interprocess::shared_memory_object object;  ///< open only where there is no name
  int creator = -1;  ///< pid of the creating process; 0 where it has attached; -1 while neither is achieved
  boost::interprocess::mapped_region region;
  ManifestView manifest;
  Block parts[kParts] = {};  ///< of the header, as checked: what a peer writes there later is not believed
  std::chrono::milliseconds slice = kSlice;  ///< the soak test makes it long, so that a lost wake-up cannot hide in it
  std::uint32_t news_seen = 0;               ///< coordinator: value of Header::news at the last look

  ~Impl();
  std::byte* base() const { return static_cast<std::byte*>(region.get_address()); }
  Header& header() const { return *reinterpret_cast<Header*>(base()); }
  PeerLine& peer(Role role) const { return header().peers[static_cast<std::size_t>(role)]; }
  Block block(Part part) const { return parts[static_cast<std::size_t>(part)]; }
  template <class T>
  std::span<T> records(Part part) const {
    const Block b = block(part);
    return {reinterpret_cast<T*>(base() + b.offset), b.bytes / sizeof(T)};
  }
  bool takes_part(Role role) const;
  /// Removes the name if the coordinator has died without doing so.
  void remove_if_orphaned() const;
};

/// Refuses a file that another user owns or can open, or that is too small for a header.
Status check_file(const struct stat& file, unsigned self);
/// Refuses a header of another protocol, or whose blocks leave the segment.
Status check_header(const Header& header, const Block (&parts)[kParts], std::uint64_t file_bytes);
/// Refuses a manifest whose indices or names leave their arrays.
Status check_manifest(const ManifestView& manifest);

}  // namespace ballast::exchange
