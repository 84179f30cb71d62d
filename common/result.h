// Errors as values: what went wrong, where, and what to do about it; with the exit code that scripts rely on.
#pragma once
#include <string>
#include <utility>
#include <variant>

namespace ballast {

/// Exit codes of every Ballast program.
enum ExitCode : int { kFine = 0, kBadInput = 2, kExpectationMissed = 3, kDiverged = 4, kProcessFailed = 5 };

struct Error {
  std::string what;   ///< what is wrong, with the value seen
  std::string cure;   ///< what to do about it
  std::string where;  ///< "file:line:column", or empty
  int exit_code = kBadInput;

  /// One message for a person: "where: what\n  cure".
  std::string text() const {
    std::string s = where.empty() ? what : where + ": " + what;
    if (!cure.empty()) s += "\n  " + cure;
    return s;
  }
};

/// Either a value or an Error. Test with `if (!result)`, then use `*result` or `result.error()`.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}
  Result(Error error) : content_(std::move(error)) {}
  explicit operator bool() const { return content_.index() == 0; }
  T& operator*() & { return std::get<0>(content_); }
  const T& operator*() const& { return std::get<0>(content_); }
  T&& operator*() && { return std::get<0>(std::move(content_)); }
  T* operator->() { return &std::get<0>(content_); }
  const T* operator->() const { return &std::get<0>(content_); }
  const Error& error() const { return std::get<1>(content_); }

 private:
  std::variant<T, Error> content_;
};

using Status = Result<std::monostate>;
inline Status ok() { return Status(std::monostate{}); }

}  // namespace ballast
