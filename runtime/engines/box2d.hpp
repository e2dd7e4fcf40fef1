// A joint of Box2D 2.4: a b2Joint that takes part in islands, sleep, warm starting and both solvers as Box2D's own do.
//
// b2World::CreateJoint() makes joints of Box2D alone, and Box2D keeps private what its joints read of a body. So the
// constructor enters the joint into the lists of the world, the destructor takes it out, and the private members are
// reached by explicit instantiations, for which the standard checks no access. Destroy the joint before its bodies and
// its world; b2World::DestroyJoint() does not know it. Points of `parameters` are those of Box2D: from the origin of a
// body, wherever its centre of mass is.
#pragma once

#include <box2d/box2d.h>

#include <cdot/kernel.hpp>

#include "runtime/engines/plain.hpp"

namespace cdot::box2d {

// reach(Tag()) is the member whose pointer instantiates Reach<Tag, ...>.
template <class Tag, typename Tag::Member member>
struct Reach {
  friend constexpr typename Tag::Member reach(Tag) { return member; }
};
struct IslandIndex {
  using Member = int32 b2Body::*;
  friend constexpr Member reach(IslandIndex);
};
struct InverseMassOfBody {
  using Member = float b2Body::*;
  friend constexpr Member reach(InverseMassOfBody);
};
struct InverseInertiaOfBody {
  using Member = float b2Body::*;
  friend constexpr Member reach(InverseInertiaOfBody);
};
struct JointsOfBody {
  using Member = b2JointEdge* b2Body::*;
  friend constexpr Member reach(JointsOfBody);
};
struct JointsOfWorld {
  using Member = b2Joint* b2World::*;
  friend constexpr Member reach(JointsOfWorld);
};
struct JointCountOfWorld {
  using Member = int32 b2World::*;
  friend constexpr Member reach(JointCountOfWorld);
};
template struct Reach<IslandIndex, &b2Body::m_islandIndex>;
template struct Reach<InverseMassOfBody, &b2Body::m_invMass>;
template struct Reach<InverseInertiaOfBody, &b2Body::m_invI>;
template struct Reach<JointsOfBody, &b2Body::m_jointList>;
template struct Reach<JointsOfWorld, &b2World::m_jointList>;
template struct Reach<JointCountOfWorld, &b2World::m_jointCount>;

// With `stiffness` and `drives` of plain::Joint. In a rigid joint Box2D's second solver closes gaps, so rows take
// nothing back at the level of velocities.
template <class Block, class... Coordinates>
class Joint : public b2Joint, public plain::Joint<float, Block, Coordinates...> {
  static_assert(Block::bodies <= 2, "a joint of Box2D joins two bodies");
  using Plain = plain::Joint<float, Block, Coordinates...>;
  static constexpr int bodies = Block::bodies;

 public:
  using Parameters = typename Block::template Parameters<float>;

  float time = 0;  // yours to set before a step, where C depends on time

  // The bodies a and b of the joint; of a joint of one body, b is any other body that does not move.
  Joint(b2World& world, b2Body& a, b2Body& b, const Parameters& p, bool collide_connected = false)
      : b2Joint(&definition(a, b, collide_connected)), world_(world) {
    this->parameters = p;
    this->stiffness.error_reduction = 0;
    b2Joint*& first = world_.*reach(JointsOfWorld());
    m_next = first;
    if (first != nullptr) first->*(&Joint::m_prev) = this;
    first = this;
    ++(world_.*reach(JointCountOfWorld()));
    enter(m_edgeA, a, b);
    enter(m_edgeB, b, a);
    filter_again();
  }
  ~Joint() override {
    m_bodyA->SetAwake(true);
    m_bodyB->SetAwake(true);
    if (m_prev != nullptr) m_prev->*(&Joint::m_next) = m_next;
    else world_.*reach(JointsOfWorld()) = m_next;
    if (m_next != nullptr) m_next->*(&Joint::m_prev) = m_prev;
    --(world_.*reach(JointCountOfWorld()));
    leave(m_edgeA, *m_bodyA);
    leave(m_edgeB, *m_bodyB);
    filter_again();
  }
  Joint(const Joint&) = delete;
  Joint& operator=(const Joint&) = delete;

  // Sets parameter number `first` (Block::index_of_pb) and those after it to their defaults at the present poses.
  void by_default(int first) {
    planar::Pose<float> q[bodies];
    for (int i = 0; i < bodies; ++i)
      q[i] = plain::pose(body(i).GetWorldCenter().x, body(i).GetWorldCenter().y, body(i).GetAngle());
    from_centres(1);
    Plain::by_default(first, q, time);
    from_centres(-1);
  }

  b2Vec2 GetAnchorA() const override { return m_bodyA->GetWorldCenter(); }
  b2Vec2 GetAnchorB() const override { return m_bodyB->GetWorldCenter(); }
  b2Vec2 GetReactionForce(float inv_dt) const override {
    const planar::Velocity<float> impulse = reaction();
    return {inv_dt * impulse.x, inv_dt * impulse.y};
  }
  // About the centre of mass of body B.
  float GetReactionTorque(float inv_dt) const override { return inv_dt * reaction().w; }

  void Dump() override {}  // a program that recreates the world knows no other joints than Box2D's

 protected:
  void InitVelocityConstraints(const b2SolverData& data) override {
    for (int i = 0; i < bodies; ++i)
      m_[i] = {body(i).*reach(InverseMassOfBody()), body(i).*reach(InverseInertiaOfBody())};
    if (!data.step.warmStarting) this->forget();
    read(data);
    from_centres(1);
    this->prepare(q_, m_, time, data.step.dt);
    from_centres(-1);
    this->warm_start(m_, v_);
    write_velocities(data);
  }
  void SolveVelocityConstraints(const b2SolverData& data) override {
    read(data);
    this->solve(m_, v_);
    write_velocities(data);
  }
  bool SolvePositionConstraints(const b2SolverData& data) override {
    read(data);
    from_centres(1);
    const float worst = this->project(q_, m_, time);
    from_centres(-1);
    for (int i = 0; i < bodies; ++i) {
      b2Position& to = data.positions[index(i)];
      to.c.Set(q_[i].x, q_[i].y);
      to.a = q_[i].angle;
    }
    return worst <= b2_linearSlop;
  }

 private:
  // The base class copies it.
  static const b2JointDef& definition(b2Body& a, b2Body& b, bool collide_connected) {
    thread_local b2JointDef made;
    made.bodyA = &a;
    made.bodyB = &b;
    made.collideConnected = collide_connected;
    return made;
  }
  void enter(b2JointEdge& edge, b2Body& body, b2Body& other) {
    b2JointEdge*& first = body.*reach(JointsOfBody());
    edge = {&other, this, nullptr, first};
    if (first != nullptr) first->prev = &edge;
    first = &edge;
  }
  static void leave(b2JointEdge& edge, b2Body& body) {
    if (edge.prev != nullptr) edge.prev->next = edge.next;
    else body.*reach(JointsOfBody()) = edge.next;
    if (edge.next != nullptr) edge.next->prev = edge.prev;
  }
  // Contacts of bodies that must not collide, or may do so again.
  void filter_again() {
    for (b2Fixture* f = m_bodyB->GetFixtureList(); f != nullptr && !m_collideConnected; f = f->GetNext()) f->Refilter();
  }

  b2Body& body(int i) const { return i == 0 ? *m_bodyA : *m_bodyB; }
  int32 index(int i) const { return body(i).*reach(IslandIndex()); }
  // Points from the origins of the bodies to their centres of mass, and back.
  void from_centres(float sign) {
    for (int i = 0; i < bodies; ++i) {
      const b2Vec2 centre = sign * body(i).GetLocalCenter();
      Block::move_origin(this->parameters, i, {centre.x, centre.y});
    }
  }
  void read(const b2SolverData& data) {
    for (int i = 0; i < bodies; ++i) {
      const b2Position& x = data.positions[index(i)];
      const b2Velocity& v = data.velocities[index(i)];
      q_[i] = plain::pose(x.c.x, x.c.y, x.a);
      v_[i] = {v.v.x, v.v.y, v.w};
    }
  }
  void write_velocities(const b2SolverData& data) const {
    for (int i = 0; i < bodies; ++i) data.velocities[index(i)] = {{v_[i].x, v_[i].y}, v_[i].w};
  }
  // On the last body of the joint.
  planar::Velocity<float> reaction() const {
    planar::InverseMass<float> one[bodies];
    for (auto& m : one) m = {1, 1};
    planar::Velocity<float> impulse[bodies] = {};
    Plain copy = *this;
    copy.warm_start(one, impulse);
    return impulse[bodies - 1];
  }

  b2World& world_;
  planar::Pose<float> q_[bodies];
  planar::InverseMass<float> m_[bodies];
  planar::Velocity<float> v_[bodies];
};

}  // namespace cdot::box2d
