#include "derive/compile/identifiers.hpp"

#include <cctype>
#include <sstream>

namespace cdot::compile {

std::set<std::string> taken_names() {
  std::istringstream words(
      "T q v a J C Cdot g b d s h i k at x y w c time rows bodies pivot select abs sign turn close errors evaluate "
      "rates gamma solve step reset begin push fall move weighed project slope State energy Pose Slope Body lambda "
      "inverse accelerate Velocity Jacobian Evaluated default_step int float double for if do new this and or not "
      "auto const static struct case switch default return template left largest next kick potential E sum free B "
      "Bounded Bound bounded Mask entry divide settle part find_active p Inputs find_contradiction is_rate reach "
      "past along hold mu residual error moves Vector Tensor Gyroscope Rate Pack NumberOf angles Angles count "
      "next_angles weighed_at_least weighed_at_most is_slight Kinds append lower share shift "
      "to pull scenes std still choose rate_of larger foresee remember exert apply aim Aim Multipliers is_pack "
      "orient weigh wind follow drift spin dot cross times root half_turn turned to_world to_body turn_by free_turn "
      "inverse_root wide_half_turn add trace turn_within newton_step mean_spin sin_cos sin_cos_beside magnitude any "
      "Four WideOf Wide Places gather scatter sin_cos_of sin_cos_near sin_cos_after orient_four shift_four drift_four "
      "follow_four "
      "single epsilon "
      "smallest is_rate "
      "settle part_and_settle Guards Modes modes guard resolve force slight smaller gap stride replace furthest "
      "first_event go_to_event choose_modes decide stop_what_hits find_margins raise_resolutions hold_passed_ends "
      "has_one_end is_equation is_endless of_value of_rate of_force of_hop latch events Events distances after until "
      "go rescue improve stiffen weigh_effects farthest moved_energy hardly_moves drag "
      "advance pass tension stiffened inverse_of positive_part effect_rows Inertia W power before middle mean "
      "mean_of find_mean_spins missed side given end guess load from bonds Bonds snap strain struck stuck Search "
      "RootSearch "
      "choose_once find_blow find_pressed_ends start_motors lacks pressed stands growth meets softness half "
      "usual_softness is_free taken "
      "latches "
      "Bits WordOf Exponential Logarithm Complex Differences Newton LU freedom unknowns place_of reciprocal set_zero "
      "factor turn_back turn_on numbers_of "
      "solve_shifted differentiate slopes_of largest_change find_increments collocate end re im shift by_pose "
      "cone_of in_cone size_in_cone most_in_cone may_go instead begin_corners find_corners aim_cones share turns "
      "turned drift_of_ends moves of_ends "
      "by_velocity body_of begins ends widest begin_of end_of set_difference take_difference side_at_start off "
      "Coordinate coordinates coordinates_of Reaction reactions reactions_of value side_at_end settle_share "
      "settle_loads "
      "change_loads beyond approach by find_tangent go_along find_impulses place aim_angles step_by_rows turn_exactly "
      "Freedom "
      "Excess "
      "angles_kept F fits found foreseen missed other turns");
  std::set<std::string> names;
  for (std::string word; words >> word;) names.insert(word);
  return names;
}

std::string identifier(const std::string& name) {
  std::string text;
  for (const char c : name) text += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0])) != 0) text = "_" + text;
  return text;
}

std::string unused(std::string name, std::set<std::string>& used) {
  while (!used.insert(name).second) name += "_";
  return name;
}

}  // namespace cdot::compile
