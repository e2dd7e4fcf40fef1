// Bounds on the price of a search and of its runs, measured over all scenes.
#pragma once

namespace cdot {

// Prices, in evaluations of an island's accelerations. All runs of a search together may take
// RunOptions::search_work, or so many times the price of steps of a millisecond, if
inline constexpr double most_millisecond_runs = 20;
// that is more than so many times the price of the first run that has ended with steps of its own: 1e-12 of its local
// error costs 32 times as much.
inline constexpr double most_first_runs = 50;
// If nobody asked for the accuracy, they take less: so much work, some seconds, or if it is more, so many times that
// price. After two that did not end, or left steps to another method, few of the next ones get any further.
inline constexpr double unasked_work = 7e7, unasked_work_of_others = 5e6, most_unasked_runs = 4;
// Refinements in a row by fixed steps that do not converge, or runs that do not end.
inline constexpr int most_idle = 3;
// A run that promises to be the last goes beyond the budget if it should cost at most `dearest_last` times the one
// before, as one of order 8 by a thousandth of the local error. That price is known to about the margin.
inline constexpr double dearest_last = 2.4, margin_of_last = 1.25;
// A scene is surely stiff if an oscillation of tensions and springs at the start makes explicit steps `dear`. It may be
// if a run has taken `suspicious` evaluations, is on the way to `dear`, and the fastest oscillation explains a share of
// that price. Then methods for stiff scenes get such a share to be cheaper.
inline constexpr double suspicious = 600, dear = 4000, share_of_stiff = 0.33, share_of_surely_stiff = 0.5;
inline constexpr double steps_of_collocation = 10;  // half of its first run, or less
// If nobody asked for the accuracy: work of collocation before the lowest order goes on, and of that then. In large
// mechanisms a unit takes a microsecond. A run of collocation that has left a step to another method, which ends few
// searches, ends after less.
inline constexpr double first_work_of_collocation = 2e6, work_of_lowest_order = 5e6, work_if_rescued = 5e5;
// Even motions: steps have grown without bound, in so few evaluations. They get explicit steps of equal length if
// stable ones cost at most `slow`.
inline constexpr double even = 150, slow = 150;

}  // namespace cdot
