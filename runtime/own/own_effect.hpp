// Laws of effects behind tapes, with the members of generated effects: EffectLaw, LinearLaw and BoundedLaw call them.
#pragma once

#include <cdot/detail/bounded_law.hpp>
#include <cdot/detail/linear_law.hpp>

#include "runtime/own/own_rows.hpp"

namespace cdot {

template <class T>
using OwnParameters = OwnJoint<1>::Parameters<T>;

// All laws of tapes are told the effective mass; that they need it, and that they are linear, OwnOnCoordinate says.
template <int rows_>
class OwnEffect {
 public:
  static constexpr int rows = rows_;
  static constexpr bool law_in_time = false, reads_mass = true, slopes_vanish = false;  // Law has the truth
  template <class T>
  using Parameters = OwnParameters<T>;

  explicit OwnEffect(const void* law)
      : acts(static_cast<const OwnLaw*>(law)->acts), law_(*static_cast<const OwnLaw*>(law)) {}
  const std::vector<bool>& acts;
  bool stores() const { return law_.energy.exists(); }

  template <class T>
  void energy(const T (&C)[rows], const OwnParameters<T>& p, T mass, T& E) const {
    run_own<T>(law_.energy, {.parameters = p.number, .C = C, .effective_mass = &mass}, &E);
  }
  template <class T>
  void force(const T (&C)[rows], const T (&rate)[rows], const OwnParameters<T>& p, T time, T mass, T (&F)[rows]) const {
    run_own<T>(law_.force, at(C, rate, p, time, mass), F);
  }
  template <class T>
  void unstored(const T (&C)[rows], const T (&rate)[rows], const OwnParameters<T>& p, T time, T mass,
                T (&F)[rows]) const {
    std::fill_n(F, rows, T(0));
    if (law_.unstored.exists()) run_own<T>(law_.unstored, at(C, rate, p, time, mass), F);
  }
  template <class T>
  void slopes(const T (&C)[rows], const T (&rate)[rows], const OwnParameters<T>& p, T time, T mass, T (&k)[rows][rows],
              T (&d)[rows][rows]) const {
    run_own<T>(law_.slopes, at(C, rate, p, time, mass), *k, *d);
  }
  template <class T>
  void limits(const T (&C)[rows], const OwnParameters<T>& p, T time, T (&lower)[rows], T (&upper)[rows]) const {
    run_own<T>(law_.limits, {.parameters = p.number, .time = &time, .C = C}, lower, upper);
  }

 private:
  template <class T>
  static OwnArguments<T> at(const T (&C)[rows], const T (&rate)[rows], const OwnParameters<T>& p, const T& time,
                            const T& mass) {
    return {.parameters = p.number, .time = &time, .C = C, .rate = rate, .effective_mass = &mass};
  }

  const OwnLaw& law_;
};

// A bounded row; with events, if it begins or ends by one.
template <bool of_rate_, bool events>
class OwnBoundedRow {
 public:
  static constexpr bool of_rate = of_rate_, in_time = false, of_value = false;  // Law has the truth
  static constexpr int load_of = -1;

  explicit OwnBoundedRow(const void* bound) : bound_(*static_cast<const OwnBound*>(bound)) {}
  bool waits() const { return bound_.after.exists(); }

  template <class T>
  void bounds(const T (&C)[1], const OwnParameters<T>& p, T time, RowBounds<T>& B) const {
    run_own<T>(bound_.bounds, {.parameters = p.number, .time = &time, .C = C}, &B.lower);
  }
  template <class T>
  void by_load(const T (&C)[1], const OwnParameters<T>& p, T time, RowBounds<T>& B) const {
    run_own<T>(bound_.by_load, {.parameters = p.number, .time = &time, .C = C}, &B.lower);
  }
  template <class T>
  void after(const T (&C)[1], const T (&rate)[1], const OwnParameters<T>& p, T time, T load,
             T& D) const requires events {
    distance(bound_.after, C, rate, p, time, load, D);
  }
  template <class T>
  void until(const T (&C)[1], const T (&rate)[1], const OwnParameters<T>& p, T time, T load,
             T& D) const requires events {
    distance(bound_.until, C, rate, p, time, load, D);
  }

 private:
  template <class T>
  static void distance(const OwnFunction& from, const T (&C)[1], const T (&rate)[1], const OwnParameters<T>& p,
                       const T& time, const T& load, T& D) {
    run_own<T>(from, {.parameters = p.number, .time = &time, .C = C, .rate = rate, .load = &load}, &D);
  }

  const OwnBound& bound_;
};

}  // namespace cdot
