#!/usr/bin/env bash
# Emits every joint of specs/ for every engine whose headers are installed. Has GCC and Clang read a program that makes
# all joints of an engine. Prints the joints that an engine refuses, with its reason. Run by hand: it takes minutes.
#   [JOLT=FOLDER] tests/derive/engines/every_joint.sh [CDOT] [FOLDER]     FOLDER: for the headers, else a temporary one
set -uo pipefail
root=$(cd "$(dirname "$0")/../../.." && pwd)
cdot=${1:-$root/build/dev/derive/cdot}
folder=${2:-$(mktemp -d)}
jolt=${JOLT:-/usr/include}
failed=0
if [ ! -x "$cdot" ]; then
  echo "$cdot: no such program" >&2
  exit 2
fi

# A header by which an engine is known to be installed, and the flags to include it.
header_of() {
  case $1 in
    plain) echo "$root/runtime/engines/plain.hpp" ;;
    bullet) echo /usr/include/bullet/btBulletDynamicsCommon.h ;;
    box2d) echo /usr/include/box2d/box2d.h ;;
    jolt) echo "$jolt/Jolt/Jolt.h" ;;
    simbody) echo /usr/include/simbody/Simbody.h ;;
    dart) echo /usr/include/dart/dynamics/BodyNode.hpp ;;
    ode) echo /usr/include/ode/ode.h ;;
  esac
}
flags_of() {
  case $1 in
    bullet) echo -DBT_USE_DOUBLE_PRECISION -isystem /usr/include/bullet ;;
    jolt) echo -isystem "$jolt" ;;
    simbody) echo -isystem /usr/include/simbody ;;
    dart) echo -isystem /usr/include/eigen3 ;;
  esac
}

# A function that makes a joint J with the kernel K, so that all of it is compiled.
maker_of() {
  local take="const typename J::Parameters p{};"
  case $1 in
    plain) cat << 'END' ;;
template <class K, class J, class Pose, class Mass, class Velocity>
void make() {
  J j;
  Pose q[K::bodies] = {};
  Mass m[K::bodies] = {};
  Velocity v[K::bodies] = {};
  j.by_default(0, q, 0);
  j.prepare(q, m, 0, 1);
  j.warm_start(m, v);
  j.solve(m, v);
  j.project(q, m, 0);
}
END
    bullet | jolt)
      local body=btRigidBody
      if [ "$1" = jolt ]; then body=JPH::Body; fi
      echo "template <class K, class J> void make($body& a) { $take"
      if [ "$1" = jolt ]; then echo "J(a, a, p).by_default(0); }"; else
        echo "if constexpr (K::bodies == 1) J(a, p).by_default(0); else J(a, a, p).by_default(0); }"
      fi
      ;;
    box2d) echo "template <class K, class J> void make(b2World& w, b2Body& a) { $take J(w, a, a, p).by_default(0); }" ;;
    ode)
      echo "template <class K, class J> void make(dWorldID w, dBodyID a) { $take"
      echo "if constexpr (K::bodies == 1) new J(w, a, p); else (new J(w, a, a, p))->by_default(0); }"
      ;;
    simbody | dart)
      local body=dart::dynamics::BodyNode*
      if [ "$1" = simbody ]; then body="SimTK::MobilizedBody&"; fi
      echo "template <class K, class J> void make($body a) { $take"
      echo "if constexpr (K::bodies == 1) J(p, a); else if constexpr (K::bodies == 2) J(p, a, a);"
      echo "else if constexpr (K::bodies == 3) J(p, a, a, a); else J(p, a, a, a, a); }"
      ;;
  esac
}
arguments_of() {
  case $1 in
    plain) echo "" ;;
    bullet) echo "btRigidBody&" ;;
    jolt) echo "JPH::Body&" ;;
    box2d) echo "b2World&, b2Body&" ;;
    ode) echo "dWorldID, dBodyID" ;;
    simbody) echo "SimTK::MobilizedBody&" ;;
    dart) echo "dart::dynamics::BodyNode*" ;;
  esac
}

# All joints of a space for an engine; `program` makes those that it takes.
emit_all() {
  local engine=$1 space=$2 program=$3 made=""
  for spec in "$root/specs/$space"/*.joint; do
    local joint kernel class said=$folder/said
    joint=$(basename "$spec" .joint)
    kernel=cdot::$space::$joint
    class=cdot::$engine::${joint}_joint
    if [ "$engine" = plain ]; then
      class="$class<double>, cdot::$space::Pose<double>, cdot::$space::InverseMass<double>, cdot::$space::Velocity<double>"
    fi
    if "$cdot" emit "$spec" --for "$engine" -o "$folder/$engine/$space/$joint.hpp" > "$said" 2>&1; then
      echo "#include \"$joint.hpp\"" >> "$program"
      made+="template void make<$kernel, $class>($(arguments_of "$engine"));"$'\n'
    elif ! grep -qE "it is (planar|spatial), and the bodies" "$said"; then
      echo "$space/$joint: $(grep "cannot be emitted" "$said" || tail -1 "$said")"
      if ! grep -q "cannot be emitted" "$said"; then failed=1; fi
    fi
  done
  maker_of "$engine" >> "$program"
  echo "$made" >> "$program"
}

for engine in plain bullet box2d jolt simbody dart ode; do
  if [ ! -f "$(header_of $engine)" ]; then
    echo "$engine: not installed"
    continue
  fi
  for space in planar spatial; do
    mkdir -p "$folder/$engine/$space"
    program=$folder/$engine/$space/all.cpp
    : > "$program"
    emit_all $engine $space "$program"
    joints=$(grep -c "^#include" "$program")
    if [ "$joints" = 0 ]; then continue; fi
    for compiler in g++ clang++; do
      # shellcheck disable=SC2046
      if $compiler -std=c++17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only $(flags_of $engine) "$program"; then
        echo "$engine: $compiler reads $joints $space joints"
      else
        echo "$engine: $compiler fails"
        failed=1
      fi
    done
  done
done
exit $failed
