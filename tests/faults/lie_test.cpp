// A run whose mailbox somebody writes into ends with exit code 5 and names the field.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <regex>

#include "common/exchange/layout.h"
#include "common/exchange/records.h"
#include "tests/validation/run_command.h"

namespace ballast::testing {
namespace {

using exchange::Header;
using exchange::Part;

/// The shared memory of a run: its coordinator keeps it open, without a name.
class Memory {
 public:
  explicit Memory(pid_t coordinator) {
    for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(coordinator) + "/fd")) {
      std::error_code gone;
      if (fs::read_symlink(entry.path(), gone).string().find("/dev/shm/ballast-") == std::string::npos) continue;
      const int file = open(entry.path().c_str(), O_RDWR | O_CLOEXEC);
      struct stat status {};
      if (file < 0) continue;
      if (fstat(file, &status) == 0) {
        bytes_ = static_cast<std::size_t>(status.st_size);
        base_ = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
      }
      close(file);
    }
  }
  ~Memory() {
    if (found()) munmap(base_, bytes_);
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  bool found() const { return base_ != nullptr && base_ != MAP_FAILED; }
  template <class T>
  T* at(Part part, std::size_t offset = 0) const {
    const auto* header = static_cast<const Header*>(base_);
    return reinterpret_cast<T*>(static_cast<std::byte*>(base_) + header->parts[static_cast<std::size_t>(part)].offset +
                                offset);
  }

 private:
  void* base_ = nullptr;
  std::size_t bytes_ = 0;
};

/// Bytes without any sense over a message and the records behind it.
template <class Head, class Record>
void scribble(const Memory& memory, Part part) {
  static std::mt19937_64 random(7);
  std::byte noise[sizeof(Head) + 2 * sizeof(Record)];
  for (std::byte& b : noise) b = static_cast<std::byte>(random());
  std::memcpy(memory.at<std::byte>(part), noise, sizeof noise);
}

struct Lie {
  const char* name;
  std::function<void(const Memory&)> write;
  const char* field;  ///< what the message must name; a regular expression
};

struct Lied : ::testing::TestWithParam<Lie> {};

TEST_P(Lied, RunEndsAndNamesTheField) {
  const Scratch scratch;
  Command run(scratch.path, {scene("floating_box"), "--duration", "10000s", "--set", "expect=[]", "--set",
                             "numerics.relax=false", "--timeout", "10"});
  ASSERT_TRUE(run.has_children(2)) << run.text();
  const Memory memory(run.pid());
  ASSERT_TRUE(memory.found());
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // into the steps
  // A message lies there for some microseconds only: written again and again until one of them is read.
  for (int k = 0; k < 20'000'000 && (k % 1000 != 0 || !run.attached().empty()); ++k) GetParam().write(memory);
  EXPECT_EQ(run.wait(), 5) << run.text();
  EXPECT_TRUE(std::regex_search(run.text(), std::regex(GetParam().field))) << run.text();
  EXPECT_EQ(run.record().value("exit", -1), 5);
  EXPECT_TRUE(run.attached().empty());
}

const Lie kLies[] = {
    {"NanForce",
     [](const Memory& m) {
       m.at<exchange::Wrench>(Part::kOrder, sizeof(exchange::Order))[1].force[2] =
           std::numeric_limits<double>::quiet_NaN();
     },
     "force"},
    {"WrongStep", [](const Memory& m) { m.at<exchange::Order>(Part::kOrder)->step = 77; }, "step"},
    {"WrongCount", [](const Memory& m) { m.at<exchange::Order>(Part::kOrder)->bodies = 4000000000u; }, "bodies"},
    {"NanPosition",
     [](const Memory& m) {
       m.at<exchange::BodyState>(Part::kAnswer, sizeof(exchange::Answer))[1].position[0] =
           std::numeric_limits<double>::quiet_NaN();
     },
     "position"},
    // Which field is refused first hangs on the bytes; "sent FIELD = VALUE, expected" is how each is named.
    {"RandomOrder", [](const Memory& m) { scribble<exchange::Order, exchange::Wrench>(m, Part::kOrder); },
     "the fluid process .* sent [a-z_]+.* = .*, expected"},
    {"RandomAnswer", [](const Memory& m) { scribble<exchange::Answer, exchange::BodyState>(m, Part::kAnswer); },
     // States that are finite, and lie there beside a header that is right again, pass: what comes of them does not.
     "the (rigid|fluid) process .* sent [a-z_]+.* = .*, expected"},
};

INSTANTIATE_TEST_SUITE_P(Fields, Lied, ::testing::ValuesIn(kLies),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace ballast::testing
