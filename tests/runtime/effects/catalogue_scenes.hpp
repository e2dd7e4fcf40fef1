// A scene for each effect of the catalogue: its numbers, and how its bodies start. The test of a new effect begins
// here.
#pragma once

#include <string>
#include <vector>

#include <cdot/effects.hpp>

namespace cdot::test::catalogue {

// smooth: the force has all derivatives along this scene. event: a row comes into reach, lets go, slips or sticks.
enum class Kind { smooth, event };

struct Start {
  double x = 1, y = 0.3, vx = 0.3, vy = 0.5, w = 1;
};

struct Scene {
  std::string name;
  Kind kind;
  std::vector<NamedValue> numbers;  // without points, which all have the same, and without frames
  Start a{};
  bool grounded = false;  // b is the ground
  double gravity = 0;     // [m/s^2], down
  double ramp = 0;        // a load on the coordinate grows by it [N/s, N m/s]
  // The ball lands and rubs. While an impact lasts, friction turns the slip, and so itself. Methods that locate the
  // impact solve it at once, the others in one step or in two, as it falls: no step removes that difference.
  bool rubs_as_it_lands = false;
};

// clang-format off
inline const std::vector<Scene>& planar_scenes() {
  static const std::vector<Scene> all = {
      {"bearing_friction", Kind::smooth, {{"most", {0.8}}, {"creep", {0.9}}}},
      {"bungee", Kind::smooth, {{"k", {40}}, {"rest", {0.5}}, {"rounding", {0.5}}}},
      {"buoyancy", Kind::smooth, {{"k", {20}}, {"surface", {0, 0.8}}, {"rounding", {0.5}}}},
      {"bushing", Kind::smooth, {{"kx", {30}}, {"ky", {50}}, {"k_turn", {8}}}},
      {"couple", Kind::smooth, {{"M", {1.5}}}},
      {"damper", Kind::smooth, {{"d", {2}}}},
      {"dc_motor", Kind::smooth, {{"stall", {2}}, {"idle", {5}}}},
      {"detent", Kind::smooth, {{"count", {3}}, {"most", {1.5}}, {"d", {0.2}}}},
      {"drag", Kind::smooth, {{"c", {0.7}}}},
      {"duffing_spring", Kind::smooth, {{"k", {20}}, {"k3", {30}}, {"rest", {0.5}}}},
      {"gas_spring", Kind::smooth, {{"F", {4}}, {"rest", {1}}, {"kappa", {1.4}}}},
      {"gravity_between", Kind::smooth, {{"mu", {0.5}}}},
      {"gravity_well", Kind::smooth, {{"mu", {3}}, {"centre", {0, -1}}}},
      {"induction_motor", Kind::smooth, {{"synchronous", {6}}, {"pull_out", {2}}, {"pull_out_slip", {0.3}}}},
      {"lift", Kind::smooth, {{"c", {0.6}}}},
      {"linear_actuator", Kind::smooth, {{"k", {30}}, {"d", {1}}, {"rest", {1}}, {"stroke", {0.2}}, {"omega", {3}}}},
      {"magnetic_field", Kind::smooth, {{"strength", {3}}}},
      {"position_drive", Kind::smooth, {{"target", {0.5}}, {"k", {8}}, {"d", {0.5}}, {"most", {100}}}},
      {"membrane", Kind::smooth, {{"k", {30}}, {"rest", {0.3}}, {"d", {0.4}}}},
      {"push", Kind::smooth, {{"F", {1, 2}}}},
      {"rotational_drag", Kind::smooth, {{"c", {0.4}}}},
      {"servo", Kind::smooth, {{"target", {0.5}}, {"k", {8}}, {"d", {0.5}}, {"most", {3}}}},
      {"shaker", Kind::smooth, {{"amplitude", {2, 1}}, {"omega", {4}}}},
      {"soft_stop", Kind::smooth, {{"least", {1.5}}, {"k", {10}}, {"rounding", {0.5}}}},
      {"spring", Kind::smooth, {{"k", {50}}, {"rest", {0.8}}, {"d", {0.5}}}},
      {"thruster", Kind::smooth, {{"F", {2}}}},
      {"torsion_spring", Kind::smooth, {{"k", {8}}, {"d", {0.3}}}},
      {"viscous_drag", Kind::smooth, {{"d", {0.8}}}},
      {"wind", Kind::smooth, {{"wind_velocity", {1, -2}}, {"c", {0.5}}}},
      {"air_brake", Kind::event, {{"torque", {1}}, {"rise", {0.4}}}},
      {"backlash", Kind::event, {{"play", {0.5}}}},
      {"brake", Kind::event, {{"torque", {0.9}}}},
      {"conveyor", Kind::event, {{"speed", {0.8}}, {"most", {3}}, {"t", {1, 0}}}, {}, true},
      {"disc_in_ring", Kind::event, {{"radius_a", {0.3}}, {"radius_b", {1.5}}, {"mu", {0.3}}}, {.vx = 0.6}},
      {"disc_on_disc", Kind::event, {{"radius_a", {0.4}}, {"radius_b", {0.55}}, {"mu", {0.3}}}, {.vx = -0.8}},
      {"disc_on_line", Kind::event, {{"n", {0, 1}}, {"radius", {0.2}}}, {.y = 0.6, .vy = -1}, true, 3},
      {"end_stops", Kind::event, {{"t", {1, 0}}, {"lower", {-1}}, {"upper", {0.2}}}, {.vx = 0.6}, true},
      {"freewheel", Kind::event, {{"most", {2}}}, {.w = -2}},
      {"press_fit", Kind::event, {{"t", {1, 0}}, {"c", {4}}}, {.vx = 1.5}, true},
      {"ratchet", Kind::event, {{"count", {3}}, {"most", {8}}, {"flank", {0.6}}}, {.w = -3}},
      {"rough_line", Kind::event, {{"n", {0, 1}}, {"radius", {0.2}}, {"mu", {0.3}}}, {.y = 0.6, .vx = 1, .vy = -1}, true, 3, 0, true},
      {"spindle", Kind::event, {{"speed", {2}}, {"ramp", {0.5}}, {"most", {1}}}},
      {"tearing_rope", Kind::event, {{"l", {1.3}}, {"strength", {1000}}}},
  };
  return all;
}

inline const std::vector<Scene>& spatial_scenes() {
  static const std::vector<Scene> all = {
      {"bungee", Kind::smooth, {{"k", {40}}, {"rest", {0.5}}, {"rounding", {0.5}}}},
      {"buoyancy", Kind::smooth, {{"surface", {0, 0, 0.3}}, {"radius", {2}}, {"weight", {9}}}},
      {"bushing", Kind::smooth, {{"k_along", {30}}, {"k_across", {50}}, {"k_twist", {8}}, {"k_bend", {6}}}},
      {"couple", Kind::smooth, {{"M", {1.5, 0.5, -1}}}},
      {"damper", Kind::smooth, {{"d", {2}}}},
      {"dc_motor", Kind::smooth, {{"stall", {2}}, {"idle", {5}}}},
      {"drag", Kind::smooth, {{"c", {0.7}}}},
      {"gas_spring", Kind::smooth, {{"F", {4}}, {"rest", {1}}, {"kappa", {1.4}}}},
      {"gravity_between", Kind::smooth, {{"mu", {0.5}}}},
      {"gravity_well", Kind::smooth, {{"mu", {3}}, {"centre", {0, -1, 0}}}},
      {"magnetic_field", Kind::smooth, {{"B", {1, 2, -1}}}},
      {"magnus", Kind::smooth, {{"c", {0.8}}}},
      {"membrane", Kind::smooth, {{"k", {30}}, {"rest", {0.3}}, {"d", {0.4}}}},
      {"push", Kind::smooth, {{"F", {1, 2, -1}}}},
      {"rotational_drag", Kind::smooth, {{"c", {0.4}}}},
      {"servo", Kind::smooth, {{"target", {0.5}}, {"k", {8}}, {"d", {0.5}}, {"most", {3}}}},
      {"shaker", Kind::smooth, {{"amplitude", {2, 1, -1}}, {"omega", {4}}}},
      {"spring", Kind::smooth, {{"k", {50}}, {"rest", {0.8}}, {"d", {0.5}}}},
      {"thruster", Kind::smooth, {{"F", {2}}}},
      {"torsion_spring", Kind::smooth, {{"k", {8}}, {"d", {0.3}}}},
      {"viscous_drag", Kind::smooth, {{"d", {0.8}}}},
      {"wind", Kind::smooth, {{"wind_velocity", {1, -2, 0.5}}, {"c", {0.5}}}},
      {"ball_in_bowl", Kind::event, {{"f", {-1, 0, 0, 0, 1, 0}}, {"radius_a", {0.3}}, {"radius_b", {1.5}}, {"mu", {2}}}, {.vx = 0.6}},
      {"ball_on_ball", Kind::event, {{"f", {1, 0, 0, 0, 1, 0}}, {"radius_a", {0.4}}, {"radius_b", {0.55}}, {"mu", {0.3}}}, {.vx = -0.8}},
      {"ball_on_plane", Kind::event, {{"n", {0, 1, 0}}, {"radius", {0.2}}}, {.y = 0.6, .vy = -1}, true, 3},
      {"brake", Kind::event, {{"torque", {0.9}}}},
      {"conveyor", Kind::event, {{"speed", {0.8}}, {"most", {3}}, {"t", {1, 0, 0}}}, {}, true},
      {"end_stops", Kind::event, {{"t", {1, 0, 0}}, {"lower", {-1}}, {"upper", {0.2}}}, {.vx = 0.6}, true},
      {"press_fit", Kind::event, {{"t", {1, 0, 0}}, {"c", {4}}}, {.vx = 1.5}, true},
      {"rough_plane", Kind::event, {{"f", {0, 1, 0, 1, 0, 0}}, {"radius", {0.2}}, {"mu", {0.3}}}, {.y = 0.6, .vx = 1, .vy = -1}, true, 3, 0, true},
      {"spindle", Kind::event, {{"speed", {3}}, {"ramp", {0.5}}, {"most", {2}}}},
      {"tearing_rope", Kind::event, {{"l", {1.3}}, {"strength", {1000}}}},
  };
  return all;
}

// Of effects on any coordinate: on the angle of a pendulum, or on the slide of a block where it is in metres.
inline const std::vector<Scene>& coordinate_scenes() {
  static const std::vector<Scene> all = {
      {"load", Kind::smooth, {{"push", {1.5}}}},
      {"spring", Kind::smooth, {{"stiffness", {30}}, {"damping", {0.4}}}},
      {"friction", Kind::event, {{"max", {4}}}},
      {"latch", Kind::event, {{"at", {0.1}}}},
      {"limit", Kind::event, {{"lower", {-0.2}}, {"upper", {0.3}}}, {.w = -1}},
      {"limit_switch", Kind::event, {{"speed", {1.5}}, {"max", {60}}, {"end", {0.3}}}},
      {"motor", Kind::event, {{"speed", {2}}, {"max", {8}}}},
      {"pin_friction", Kind::event, {{"mu", {0.5}}, {"radius", {0.3}}}},
      {"rail_friction", Kind::event, {{"mu", {0.6}}}},
      {"shear_pin", Kind::event, {{"strength", {8}}}, {.w = 0}, false, 0, -10},
      {"timed_motor", Kind::event, {{"speed", {2}}, {"max", {60}}, {"start", {0.31}}, {"stop", {0.62}}}},
  };
  return all;
}
// clang-format on

}  // namespace cdot::test::catalogue
