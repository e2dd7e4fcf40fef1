// The coefficients of Radau IIA with three stages: E. Hairer, G. Wanner, "Solving Ordinary Differential Equations II",
// 2nd edition, 1996, IV.5 and IV.8. The method is collocation at c_1, c_2, c_3 = 1: of fifth order, L-stable, and its
// last stage is the end of the step.
#pragma once

#include "runtime/step/runge_kutta_tables.hpp"

namespace cdot {

template <class Real>
inline constexpr Real root_6 = Real(2.449489742783178098197284074705891391966L);

// The three stages follow the start, whose k serves the error estimate only. The cubic through both ends has the
// polynomial's slopes there: that at the start continues the slopes at the stages, that at the end is k_3.
template <class Real>
inline constexpr RungeKutta<Real> radau5 = {
    5,
    4,
    {0, (4 - root_6<Real>) / 10, (4 + root_6<Real>) / 10, 1, 1},
    {{},
     {0, (88 - 7 * root_6<Real>) / 360, (296 - 169 * root_6<Real>) / 1800, (-2 + 3 * root_6<Real>) / 225},
     {0, (296 + 169 * root_6<Real>) / 1800, (88 + 7 * root_6<Real>) / 360, (-2 - 3 * root_6<Real>) / 225},
     {0, (16 - root_6<Real>) / 36, (16 + root_6<Real>) / 36, Real(1) / 9},
     {0, (16 - root_6<Real>) / 36, (16 + root_6<Real>) / 36, Real(1) / 9}},
    {},
    false,
    4,
    0,
    2,
    {{0, (2 + 3 * root_6<Real>) / 6, (2 - 3 * root_6<Real>) / 6, Real(1) / 3}, {0, 0, 0, 1}},
    true};

// A^-1 of the three stages: the k of increments z from the start are A^-1 z / h.
template <class Real>
inline constexpr Real radau_inverse[3][3] = {
    {2 + root_6<Real> / 2, Real(-6) / 5 + 29 * root_6<Real> / 30, Real(2) / 5 - 4 * root_6<Real> / 15},
    {Real(-6) / 5 - 29 * root_6<Real> / 30, 2 - root_6<Real> / 2, Real(2) / 5 + 4 * root_6<Real> / 15},
    {-1 + 8 * root_6<Real> / 3, -1 - 8 * root_6<Real> / 3, 5}};

// A^-1 = T diag(real, [alpha, -beta; beta, alpha]) T^-1 parts Newton's matrix into a real and a complex one.
struct RadauTransformation {
  double real = 3.637834252744495732208, alpha = 2.681082873627752133896, beta = 3.050430199247410569426;
  double T[3][3] = {{9.1232394870892942792e-02, -0.14125529502095420843, -3.0029194105147424492e-02},
                    {0.24171793270710701896, 0.20412935229379993199, 0.38294211275726193779},
                    {0.96604818261509293619, 1, 0}};
  double inverse[3][3] = {{4.3255798900631553510, 0.33919925181580986954, 0.54177053993587487119},
                          {-4.1787185915519047273, -0.32768282076106238708, 0.47662355450055045196},
                          {-0.50287263494578687595, 2.5719269498556054292, -0.59603920482822492497}};
};
inline constexpr RadauTransformation radau_transformation;

// The error estimate, of third order, (real / h - df/dy)^-1 (f(y) + sum_i e_i z_i / h).
inline constexpr double radau_error[3] = {-(13 + 7 * root_6<double>) / 3, (-13 + 7 * root_6<double>) / 3, -1.0 / 3};

}  // namespace cdot
