// Minors of J, as formulas and as numbers; and sums of squares that cannot vanish.
#pragma once

#include <vector>

#include "derive/proof/ginac.hpp"

namespace cdot::derive {

// The determinant of J's columns as chosen: as many as J has rows.
ex determinant(const std::vector<std::vector<ex>>& J, const std::vector<std::size_t>& columns);
double determinant(const std::vector<std::vector<double>>& J, const std::vector<std::size_t>& columns);
// n over k.
double number_of_choices(std::size_t n, std::size_t k);

// All even powers with positive factors, and a constant: never zero. A number other than zero is
// one.
bool is_positive(const ex& expanded, const std::vector<ex>& symbols);

}  // namespace cdot::derive
