// What LLVM's OpenMP runtime asks of the system. It notes every process in a shared-memory file of its own, that others
// can read and that stays when the process is killed; here it gets memory without a name instead.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>

#include <cerrno>
#include <string_view>

/// Found by the runtime before the C library's, which gets all other names.
extern "C" int shm_open(const char* name, int flags, mode_t mode) {
  if (std::string_view(name).starts_with("/__KMP_")) {
    if (flags & O_CREAT) return memfd_create(name, MFD_CLOEXEC);
    errno = ENOENT;  // nothing to look up again at the end
    return -1;
  }
  static const auto of_library = reinterpret_cast<decltype(&shm_open)>(dlsym(RTLD_NEXT, "shm_open"));
  return of_library(name, flags, mode);
}
