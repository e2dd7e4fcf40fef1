// A joint as a joint of ODE 0.16: a dJointID that dWorldStep and dWorldQuickStep take as ODE's own.
//
// Make it by `new`: ODE owns it from then on, and dJointDestroy() or dWorldDestroy() ends it. Attaching, enabling and
// feedback are those of any joint. A joint of ODE has six rows at most, so each coordinate has a joint of its own for
// its motor and limits, which comes and goes with the joint. Rigid rows take the ERP and CFM of the world. Points and
// directions of `parameters` are those of the bodies; a body 0 is the world.
//
// The class behind joints, dxJoint, is in ODE's sources and not among its installed headers. With these sources, define
// CDOT_ODE_SOURCES, and "joints/joint.h" is included. Without them, this header declares as much of dxJoint as a joint
// needs. The first joint that is made compares that with a hinge of the library, and calls dError() if they differ.
#pragma once

#include <ode/ode.h>

#include <cdot/kernel.hpp>

#include "runtime/engines/plain.hpp"
#include "runtime/engines/rows.hpp"

#ifdef CDOT_ODE_SOURCES
#include "joints/joint.h"
#else
static_assert(dODE_VERSION[0] == '0' && dODE_VERSION[2] == '1' && dODE_VERSION[3] == '6',
              "this header knows the joints of ODE 0.16 alone: define CDOT_ODE_SOURCES and include from ODE's sources");

struct dBase {
  void* operator new(size_t size) { return dAlloc(size); }
  void operator delete(void* it, size_t size) { dFree(it, size); }
};

struct dObject : dBase {
  virtual ~dObject();

  dxWorld* world;
  dObject *next, **tome;
  int tag;
  void* userdata;
};

struct dxJointNode {
  dxJoint* joint;
  dxBody* body;
  dxJointNode* next;
};

struct dxJoint : dObject {
  struct Info1 {
    unsigned char m, nub;
  };
  struct SureMaxInfo {
    unsigned char max_m;
  };

  unsigned flags;
  dxJointNode node[2];
  dJointFeedback* feedback;
  dReal lambda[6];

  explicit dxJoint(dxWorld* world);
  ~dxJoint() override;
  virtual void getInfo1(Info1* info) = 0;
  virtual void getInfo2(dReal fps, dReal erp, int rowskip, dReal* J1, dReal* J2, int pairskip, dReal* rhs_cfm,
                        dReal* lo_hi, int* findex) = 0;
  virtual void getSureMaxInfo(SureMaxInfo* info) = 0;
  virtual dJointType type() const = 0;
  virtual size_t size() const = 0;
  virtual void setRelativeValues();
};
#endif

namespace cdot::ode {

// Of a hinge about z through (1, 2, 3), between a body at 0 and one at (0, 0, 4), with a motor, `fps` of 10 and `erp`
// of 0.5, as the declaration above reads it.
struct HingeOfTheLibrary {
  dWorldID world = dWorldCreate();
  dBodyID a = dBodyCreate(world), b = dBodyCreate(world);
  dJointID hinge = dJointCreateHinge(world, nullptr);
  dJointFeedback feedback{};

  HingeOfTheLibrary() {
    dBodySetPosition(b, 0, 0, 4);
    dJointAttach(hinge, a, b);
    dJointSetHingeAnchor(hinge, 1, 2, 3);
    dJointSetHingeAxis(hinge, 0, 0, 1);
    dJointSetHingeParam(hinge, dParamVel, 7);
    dJointSetHingeParam(hinge, dParamFMax, 11);
    dJointSetFeedback(hinge, &feedback);
    dJointSetData(hinge, this);
    dBodySetPosition(a, 2, 0, 0);  // a gap of 2
  }
  ~HingeOfTheLibrary() { dWorldDestroy(world); }
  HingeOfTheLibrary(const HingeOfTheLibrary&) = delete;

  bool has_the_members() const {
    return hinge->world == world && hinge->userdata == this && hinge->feedback == &feedback &&
           hinge->node[0].joint == hinge && hinge->node[0].body == a && hinge->node[1].body == b;
  }
  bool has_the_functions() const {
    dxJoint::Info1 info{};
    dxJoint::SureMaxInfo most{};
    hinge->getInfo1(&info);
    hinge->getSureMaxInfo(&most);
    return hinge->type() == dJointTypeHinge && hinge->size() >= sizeof(dxJoint) && info.m == 6 && info.nub == 5 &&
           most.max_m == 6;
  }
  bool has_the_rows() const {
    constexpr int skip = 20, pairs = 3;
    dReal J1[6 * skip] = {}, J2[6 * skip] = {}, rhs_cfm[6 * pairs] = {}, lo_hi[6 * pairs] = {};
    int findex[6] = {};
    hinge->getInfo2(10, dReal(0.5), skip, J1, J2, pairs, rhs_cfm, lo_hi, findex);
    const dReal *const motor = J1 + 5 * skip, *const speed = rhs_cfm + 5 * pairs, *const force = lo_hi + 5 * pairs;
    return J1[0] == 1 && J1[4] == 3 && J1[5] == -2 && J2[0] == -1 && J2[4] == 1 && J2[5] == 2 && rhs_cfm[0] == -10 &&
           dFabs(motor[5]) == 1 && dFabs(speed[0]) == 7 && force[0] == -11 && force[1] == 11;
  }
};

// Before dxJoint is used for the first time. Members come first: no function is called where they differ.
inline void compare_with_the_library() {
  static const bool alike = [] {
    const HingeOfTheLibrary found;
    return found.has_the_members() && found.has_the_functions() && found.has_the_rows();
  }();
  if (!alike)
    dError(d_ERR_UNKNOWN,
           "Cdot's joints do not fit this build of ODE: its class dxJoint differs. "
           "Likely fix: define CDOT_ODE_SOURCES and include from the sources of this build");
}

inline spatial::Pose<dReal> pose_of(dBodyID body) {
  if (body == nullptr) return plain::pose<dReal>(0, 0, 0, 1, 0, 0, 0);
  const dReal *const x = dBodyGetPosition(body), *const e = dBodyGetQuaternion(body);
  return plain::pose<dReal>(x[0], x[1], x[2], e[0], e[1], e[2], e[3]);
}

// J_v . J_v / m + J_w . A I^-1 A' J_w of one body, a part of K_ii.
inline dReal part_of_K(dBodyID body, const dReal* J) {
  if (body == nullptr || dBodyIsKinematic(body)) return 0;
  dMass mass;
  dBodyGetMass(body, &mass);
  dVector3 w, axis[3];
  dBodyVectorFromWorld(body, J[3], J[4], J[5], w);
  const auto row = [&](int i) { return mass.I + 4 * i; };
  for (int i = 0; i < 3; ++i) dCalcVectorCross3(axis[i], row((i + 1) % 3), row((i + 2) % 3));  // of the adjugate
  dReal turning = 0;
  for (int i = 0; i < 3; ++i) turning += w[i] * dCalcVectorDot3(axis[i], w);
  return dCalcVectorLengthSquare3(J) / mass.mass + turning * inverse(dCalcVectorDot3(row(0), axis[0]));
}

// With `parameters`, `stiffness`, `time` and `drives` of rows::Joint.
template <class Block, class... Coordinates>
class Joint : public dxJoint, public rows::Joint<dReal, Block, Coordinates...> {
  static_assert(Block::bodies <= 2 && Block::rows <= 6, "a joint of ODE joins two bodies by six rows");
  using Rows = rows::Joint<dReal, Block, Coordinates...>;
  using Row = rows::Row<dReal, Block::bodies>;
  static constexpr int bodies = Block::bodies;

 public:
  using Parameters = typename Rows::Parameters;

  dReal erp = -1, cfm = -1;  // negative: those of the world

  Joint(dWorldID of, dBodyID a, const Parameters& p) : Joint(of, a, nullptr, p) {
    static_assert(bodies == 1, "this joint joins two bodies; a body 0 is the world");
  }
  Joint(dWorldID of, dBodyID a, dBodyID b, const Parameters& p) : dxJoint(compared(of)), Rows(p) {
    for (int i = 0; i < Rows::coordinates; ++i) drive_joints_[i] = new DriveJoint(*this, i);
    dJointAttach(this, a, b);
  }
  // dWorldDestroy() ends the youngest joints first: those of the drives, which take themselves out here.
  ~Joint() override {
    for (DriveJoint* const drive : drive_joints_) {
      if (drive == nullptr) continue;
      drive->owner = nullptr;
      dJointDestroy(drive);
    }
  }

  // Sets parameter number `first` (Block::index_of_pb) and those after it to their defaults at the present poses.
  void by_default(int first) { Rows::by_default(first, poses().of); }

  // The joint of the motor and limits of coordinate i, for its feedback.
  dJointID drive_joint(int i) { return drive_joints_[i]; }

 private:
  // The motor and the limits of one coordinate.
  struct DriveJoint final : dxJoint {
    Joint* owner;
    int index;

    DriveJoint(Joint& of, int i) : dxJoint(of.world), owner(&of), index(i) {}
    ~DriveJoint() override {
      if (owner != nullptr) owner->drive_joints_[index] = nullptr;
    }

    bool acts() const {
      return dJointIsEnabled(owner) && node[0].body == owner->node[0].body && node[1].body == owner->node[1].body;
    }
    void getInfo1(Info1* info) override {
      info->m = static_cast<unsigned char>(acts() ? owner->drive_count(index) : 0);
      info->nub = 0;
    }
    void getSureMaxInfo(SureMaxInfo* info) override { info->max_m = 3; }
    void getInfo2(dReal fps, dReal world_erp, int rowskip, dReal* J1, dReal* J2, int pairskip, dReal* rhs_cfm,
                  dReal* lo_hi, int*) override {
      Target to{owner, fps, rowskip, pairskip, J1, J2, rhs_cfm, lo_hi};
      owner->write_drive(index, owner->poses().of, 1 / fps, owner->erp_or(world_erp),
                         [&](const Row& row) { to.take(row, false); });
    }
    dJointType type() const override { return dJointTypeNone; }
    size_t size() const override { return sizeof(DriveJoint); }
  };

  // Where ODE wants the rows of a joint. It solves for forces: impulse = h lambda.
  struct Target {
    Joint* of;
    dReal fps;
    int rowskip, pairskip;
    dReal *J1, *J2, *rhs_cfm, *lo_hi;

    void take(const Row& row, bool soft) {
      dReal K = 0;
      for (int k = 0; k < bodies; ++k) {
        const dBodyID body = dJointGetBody(of, k);
        if (body == nullptr) continue;
        dReal* const J = body == of->node[0].body ? J1 : J2;  // ODE's first body is never the world
        for (int i = 0; i < 6; ++i) J[i] = row.J[6 * k + i];
        if (soft) K += part_of_K(body, row.J + 6 * k);
      }
      rhs_cfm[0] = row.aim;
      if (soft) rhs_cfm[1] = row.softness * K / fps;
      else if (of->cfm >= 0) rhs_cfm[1] = of->cfm;
      lo_hi[0] = row.least * fps;
      lo_hi[1] = row.most * fps;
      J1 += rowskip, J2 += rowskip, rhs_cfm += pairskip, lo_hi += pairskip;
    }
  };

  static dWorldID compared(dWorldID world) {
    compare_with_the_library();
    return world;
  }
  dReal erp_or(dReal of_world) const { return erp >= 0 ? erp : of_world; }

  struct Poses {
    spatial::Pose<dReal> of[bodies];
  };
  Poses poses() {
    Poses q;
    for (int k = 0; k < bodies; ++k) q.of[k] = pose_of(dJointGetBody(this, k));
    return q;
  }
  // ODE asks for the rows without bounds first.
  static constexpr int unbounded_rows() {
    for (int i = 0; i < Block::rows; ++i)
      if (Block::row_kinds[i] == RowKind::inequality) return i;
    return Block::rows;
  }

  void getInfo1(Info1* info) override {
    info->m = Block::rows;
    info->nub = unbounded_rows();
  }
  void getSureMaxInfo(SureMaxInfo* info) override { info->max_m = Block::rows; }
  void getInfo2(dReal fps, dReal world_erp, int rowskip, dReal* J1, dReal* J2, int pairskip, dReal* rhs_cfm,
                dReal* lo_hi, int*) override {
    const Poses q = poses();
    this->count_turns(q.of);
    Target to{this, fps, rowskip, pairskip, J1, J2, rhs_cfm, lo_hi};
    this->write_rows(q.of, 1 / fps, erp_or(world_erp), [&](const Row& row) { to.take(row, this->is_soft()); });
  }
  dJointType type() const override { return dJointTypeNone; }
  size_t size() const override { return sizeof(Joint); }
  void setRelativeValues() override {
    for (DriveJoint* const drive : drive_joints_)
      if (drive != nullptr) dJointAttach(drive, dJointGetBody(this, 0), dJointGetBody(this, 1));
  }

  DriveJoint* drive_joints_[Rows::coordinates + 1] = {};  // the last one is of none
};

}  // namespace cdot::ode
