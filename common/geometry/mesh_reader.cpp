// The child that reads, and the pipe through which it hands over what it has read: a message, or counts and arrays.
#include "common/geometry/mesh_reader.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <assimp/IOStream.hpp>
#include <assimp/Importer.hpp>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

namespace ballast::geometry {

namespace {

/// Passes on, and loses patience where assimp goes round in circles in a damaged file (its PLY reader does).
class PatientStream : public Assimp::IOStream {
 public:
  explicit PatientStream(Assimp::IOStream* inner) : inner_(inner), left_(10'000 + 4 * inner->FileSize()) {}
  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    return wait(), inner_->Read(to, size, count);
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override { return wait(), inner_->Seek(offset, origin); }
  std::size_t Tell() const override { return inner_->Tell(); }
  std::size_t FileSize() const override { return inner_->FileSize(); }
  void Flush() override {}

 private:
  void wait() {
    // assimp turns the exception into its error text; each byte could have been read four times over
    if (left_-- == 0) throw std::runtime_error("the file is damaged: reading it does not come to an end");
  }
  std::unique_ptr<Assimp::IOStream> inner_;
  std::size_t left_;
};

class PatientFiles : public Assimp::DefaultIOSystem {
 public:
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    Assimp::IOStream* inner = DefaultIOSystem::Open(file, mode);
    return inner ? new PatientStream(inner) : nullptr;
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }
};

/// What goes through the pipe first; then `message` bytes of text, or three doubles per vertex and three indices per
/// triangle.
struct Head {
  std::uint64_t message, vertices, triangles;
};

bool send(int pipe, const void* data, std::size_t bytes) {
  for (const char* at = static_cast<const char*>(data); bytes > 0;) {
    const ssize_t sent = write(pipe, at, bytes);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    at += sent, bytes -= static_cast<std::size_t>(sent);
  }
  return true;
}

void allow(int resource, double most) {
  rlimit limit{};
  if (getrlimit(static_cast<__rlimit_resource>(resource), &limit) != 0) return;
  limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(most));
  setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

/// Bytes of address space that the process has now.
double address_space() {
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

TriangleMesh gather(const aiScene& scene) {
  TriangleMesh mesh;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[m];
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v)
      mesh.vertices.emplace_back(part.mVertices[v].x, part.mVertices[v].y, part.mVertices[v].z);
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;
      mesh.triangles.push_back({base + face.mIndices[0], base + face.mIndices[1], base + face.mIndices[2]});
    }
  }
  return mesh;
}

/// The child's whole life. Nothing of it reaches the terminal: an abort of assimp prints its own source line.
[[noreturn]] void read_and_send(const std::string& file, int pipe) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int fault : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL})
    std::signal(fault, SIG_DFL);  // the caller's are not for us
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDOUT_FILENO), dup2(nowhere, STDERR_FILENO);
  std::error_code failed;
  const auto found = std::filesystem::file_size(file, failed);
  const double bytes = failed ? 0 : static_cast<double>(found);
  allow(RLIMIT_CORE, 0);
  allow(RLIMIT_CPU, 20 + bytes / 1e6);
  allow(RLIMIT_AS, address_space() + 512e6 + 300 * bytes);
  Assimp::Importer importer;
  importer.SetIOHandler(new PatientFiles);  // the importer owns it
  // Only positions matter: other attributes would split vertices along seams and open the surface.
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(file, aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (!scene || scene->mNumMeshes == 0) {
    std::string reason = importer.GetErrorString();
    if (reason.empty()) reason = "no triangles in it";
    const Head head{reason.size(), 0, 0};
    _exit(send(pipe, &head, sizeof head) && send(pipe, reason.data(), reason.size()) ? 0 : 1);
  }
  const TriangleMesh mesh = gather(*scene);
  const Head head{0, mesh.vertices.size(), mesh.triangles.size()};
  _exit(send(pipe, &head, sizeof head) &&
                send(pipe, mesh.vertices.data(), mesh.vertices.size() * sizeof mesh.vertices[0]) &&
                send(pipe, mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0])
            ? 0
            : 1);
}

std::string receive(int pipe) {
  std::string text;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t got = read(pipe, buffer, sizeof buffer);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(buffer, static_cast<std::size_t>(got));
  }
}

std::string how_ended(int status) {
  if (!WIFSIGNALED(status)) return fmt::format("its reader gave up (exit code {})", WEXITSTATUS(status));
  if (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)
    return "its reader had no end: the file is damaged, or far too large";
  return fmt::format("its reader crashed ({}): the file is damaged", strsignal(WTERMSIG(status)));
}

}  // namespace

Result<TriangleMesh> read_triangles(const std::string& file) {
  const auto refuse = [&](const std::string& reason) {
    return Error{fmt::format("cannot read mesh '{}': {}", file, reason),
                 "check the path and that the file is OBJ, STL or PLY with a closed surface", "", kBadInput};
  };
  int pipe[2];
  if (pipe2(pipe, O_CLOEXEC) != 0) return refuse(std::strerror(errno));
  const pid_t child = fork();
  if (child == 0) read_and_send(file, pipe[1]);
  close(pipe[1]);
  const std::string sent = child > 0 ? receive(pipe[0]) : "";
  close(pipe[0]);
  if (child < 0) return refuse(std::strerror(errno));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  Head head{};
  if (status != 0 || sent.size() < sizeof head) return refuse(how_ended(status));
  std::memcpy(&head, sent.data(), sizeof head);
  const char* at = sent.data() + sizeof head;
  if (head.message > 0) return refuse(std::string(at, sent.data() + sent.size()));
  TriangleMesh mesh;
  mesh.vertices.resize(head.vertices), mesh.triangles.resize(head.triangles);
  const std::size_t first = head.vertices * sizeof mesh.vertices[0], second = head.triangles * sizeof mesh.triangles[0];
  if (sent.size() != sizeof head + first + second) return refuse("its reader sent half of it");
  std::memcpy(static_cast<void*>(mesh.vertices.data()), at, first);
  std::memcpy(static_cast<void*>(mesh.triangles.data()), at + first, second);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      if (corner >= mesh.vertices.size()) return refuse("a triangle has a corner that is not in the file");
  return mesh;
}

}  // namespace ballast::geometry
