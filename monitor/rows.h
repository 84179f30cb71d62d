// Any message as rows of a table: what lcm-gen knows about a type says the columns, so that no message is named here.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "common/result.h"

namespace ballast::monitor {

/// One row for every entry of the lists of a message, its other fields repeated; one row if it has no list.
struct Rows {
  std::string type;                            ///< as in msgs/
  std::vector<std::string> columns;            ///< time, step, ..., bodies.name, bodies.position.x, ...
  std::vector<std::vector<std::string>> rows;  ///< as many words as columns; text as it is, numbers with all digits
};

/// Finds the type by the message's first eight bytes and decodes it. An error says what is wrong with the bytes.
Result<Rows> rows_of(const void* data, std::size_t bytes);

/// A line of CSV; words with commas, quotes or line breaks are quoted (RFC 4180).
std::string csv_line(const std::vector<std::string>& words);

}  // namespace ballast::monitor
