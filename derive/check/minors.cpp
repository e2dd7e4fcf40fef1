#include <cmath>

#include "derive/check/mass.hpp"

namespace cdot::derive {

ex determinant(const std::vector<std::vector<ex>>& J, const std::vector<std::size_t>& columns) {
  GiNaC::matrix m(static_cast<unsigned>(J.size()), static_cast<unsigned>(J.size()));
  for (unsigned i = 0; i < J.size(); ++i) {
    for (unsigned k = 0; k < J.size(); ++k) m(i, k) = J[i][columns[k]];
  }
  return m.determinant(GiNaC::determinant_algo::laplace);
}

double determinant(const std::vector<std::vector<double>>& J, const std::vector<std::size_t>& columns) {
  std::vector<std::vector<double>> m;
  for (const auto& row : J) {
    m.emplace_back();
    for (const std::size_t c : columns) m.back().push_back(row[c]);
  }
  double product = 1;
  for (std::size_t k = 0; k < m.size(); ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < m.size(); ++i) {
      if (std::fabs(m[i][k]) > std::fabs(m[pivot][k])) pivot = i;
    }
    if (m[pivot][k] == 0) return 0;
    if (pivot != k) std::swap(m[pivot], m[k]), product = -product;
    product *= m[k][k];
    for (std::size_t i = k + 1; i < m.size(); ++i) {
      const double factor = m[i][k] / m[k][k];
      for (std::size_t j = k; j < m.size(); ++j) m[i][j] -= factor * m[k][j];
    }
  }
  return product;
}

bool is_positive(const ex& expanded, const std::vector<ex>& symbols) {
  const GiNaC::exvector terms =
      is_a<GiNaC::add>(expanded) ? GiNaC::exvector(expanded.begin(), expanded.end()) : GiNaC::exvector{expanded};
  bool constant = false;
  for (const ex& term : terms) {
    ex factor = term;
    for (const ex& s : symbols) {
      const int degree = factor.degree(s);
      if (degree % 2 != 0) return false;
      factor = factor.coeff(s, degree);
    }
    if (!factor.info(GiNaC::info_flags::positive)) return false;
    constant = constant || is_a<numeric>(term);
  }
  return constant;
}

double number_of_choices(std::size_t n, std::size_t k) {
  double product = 1;
  for (std::size_t i = 0; i < k; ++i) {
    product *= static_cast<double>(n - i) / static_cast<double>(i + 1);
  }
  return product;
}

}  // namespace cdot::derive
