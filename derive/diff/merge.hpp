// In space what is one mistake in vectors differs in many numbers: they are told as one.
#pragma once

#include <string>
#include <vector>

#include "derive/diff/diff.hpp"
#include "derive/expression/matrix.hpp"
#include "derive/language/joint.hpp"

namespace cdot::derive {

// A block of a matrix: the rows of one vector equation, the columns of one vector; or just one of
// each.
struct BlockPlace {
  std::string row, column;
  std::string generated, hand, difference;  // its entries, as text
};

// The differences within a block as one, where one reason fits them all; else as they are. Each is
// of one entry, and component of a vector by its order.
std::vector<Difference> merged(std::vector<Difference> entries, const BlockPlace& place);

// "[a, b ; c, d]"; a single entry as it is.
std::string text_of(const Matrix& m, const Joint& joint);
// Entry by entry.
Matrix difference_of(const Matrix& hand, const Matrix& generated, const Joint& joint);
// Some rows and columns of a matrix.
Matrix part_of(const Matrix& m, int row, int rows, int column, int columns);

}  // namespace cdot::derive
