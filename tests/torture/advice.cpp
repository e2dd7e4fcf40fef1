#include "tests/torture/advice.hpp"

#include <fstream>

#include "tests/runtime/tool/followed_advice.hpp"
#include "tests/runtime/tool/support.hpp"
#include "tests/torture/draw/scene_text.hpp"
#include "tests/torture/trial.hpp"

namespace cdot::torture {

Verdict judge_advice(const Scene& scene) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "scene.toml").string();
  std::ofstream(file) << text_of(scene);
  const test::FollowedAdvice followed = test::follow_advice(file, "");
  if (!followed.fault.empty()) {
    const bool refused = followed.fault == test::refused;
    return verdict(refused ? Outcome::refused : Outcome::broken, refused ? followed.fault : "advice", followed.fault);
  }
  if (followed.silent) return verdict(Outcome::held, "silent", "");
  if (followed.options.empty()) return verdict(Outcome::limited, "nothing that was tried is a cure", "");
  return verdict(Outcome::held, "advice", "followed: " + followed.options);
}

}  // namespace cdot::torture
