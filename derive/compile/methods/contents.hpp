// The parts of a mechanism, and lines of a step that methods share, as text.
#pragma once

#include <string>

namespace cdot::compile {

// Rows of joints, effects by forces, rows with bounds, and among these some with ends; bodies in space, and among these
// some whose inertia turns with them.
struct Contents {
  bool rows = false, effects = false, bounded = false, ends = false;
  bool spatial = false, gyroscopes = false, angles = false;  // angles: that count whole turns
  // By RATTLE: effects act by their rates at the start; rates at the end are looked for; the end solves for more than
  // the joints, and so does the start of a run.
  bool rattle = false, dampens = false, looks = false, finishes = false, exerts = false;
  bool closes() const { return rows || ends; }
  bool pulls() const { return rattle && (rows || bounded); }  // a State has its joints' accelerations
};

inline constexpr const char* evaluates = "    evaluate($ss.q, s.time, s.J);\n";
inline constexpr const char* follows = "    follow(s, T(0) < T(1));\n";

inline std::string drifts(const Contents& has) {
  return has.gyroscopes ? "    drift(s, h);\n"
                        : R"(    for (int i = 0; i < bodies; ++i) s.q[i] = moved(s.q[i], h * s.v[i]);
    turn(s.q);
)";
}

}  // namespace cdot::compile
