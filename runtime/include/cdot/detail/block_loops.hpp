// The loops of BlockOps, one template for every generated row block. step() calls kernels only here.
#pragma once

#include <algorithm>
#include <type_traits>

#include <cdot/detail/block_slots.hpp>
#include <cdot/detail/drives.hpp>
#include <cdot/detail/kernel_forms.hpp>
#include <cdot/detail/turns.hpp>

namespace cdot {

// Once for all joints: a rotation by a finite angle is long.
template <class S>
[[gnu::noinline]] void displace_body(Bodies<S>& all, int body, const typename S::Velocity& moved) {
  const size_t i = static_cast<size_t>(body);
  all.pose[i] = S::moved(all.pose[i], moved);
  all.displacement[i] = S::sum(all.displacement[i], moved, typename S::Scalar(1));
}

// Joint defines the parameters. Block is the joint, a coordinate, or one of these with an immovable body.
template <class S, class Joint, class Block, Kernels kernels = Kernels::balanced>
struct BlockLoops : BlockSlots<S, Joint, Block> {
  using Slots = BlockSlots<S, Joint, Block>;
  using Slots::bodies, Slots::bodies_of, Slots::entries, Slots::gather, Slots::parameters;
  using typename Slots::Jacobian, typename Slots::Parameters, typename Slots::Real, typename Slots::T;
  using Pose = typename S::Pose;
  using Velocity = typename S::Velocity;
  using InverseMass = typename S::InverseMass;
  static constexpr int rows = Block::rows;
  static constexpr int width = S::freedom * bodies;
  static constexpr int triangle = rows * (rows + 1) / 2;
  static_assert(
      rows <= most_rows && bodies <= most_bodies,
      "a joint with more rows or bodies than most_rows, most_bodies of runtime/include/cdot/detail/block.hpp");
  using Turns = TurnCounters<S, Joint, Block>;
  // Immovable variants inherit the joint's functions that do not touch J, and so share their loops.
  using Inherited = std::conditional_t<std::is_base_of_v<Joint, Block>, BlockLoops<S, Joint, Joint>, BlockLoops>;

  static T* first_parameter(Batch<S>& batch, int slot) {
    return batch.parameters.data() + slot * batch.ops->parameter_size;
  }
  static T* counters(Batch<S>& batch, int slot) { return batch.counters.data() + slot * batch.ops->counters; }
  static void count_parameters(Batch<S>& batch, int slot, const Pose (&q)[bodies], T time) {
    if constexpr (Turns::counts_parameters)
      Turns::count_parameters(block_of<Block>(batch), q, first_parameter(batch, slot), time, counters(batch, slot));
  }
  // Their rows take C from position(): beside J, an angle at half a turn may round to the other side than as counted.
  static bool counts_some_parameters(const Batch<S>& batch) {
    return Turns::counts_parameters && batch.ops->counters > int(Turns::is_angle());
  }
  static void count_angle(Batch<S>& batch, int slot, T (&C)[rows]) {
    if constexpr (Turns::is_angle()) Turns::count_angle(block_of<Block>(batch), C[0], counters(batch, slot));
  }
  static void start_counting(Batch<S>& batch, int slot, const Bodies<S>& all, T time) {
    Pose q[bodies];
    gather(all.pose, bodies_of(batch, slot), q);
    Turns::start(block_of<Block>(batch), q, first_parameter(batch, slot), time, counters(batch, slot));
  }

  // f(poses, parameters, time) of a slot as jets: its bodies move and its parameters follow functions of time.
  template <class F>
  static void along_motion(const Batch<S>& batch, int slot, const Pose (&q)[bodies], const Velocity (&v)[bodies],
                           T time, F f) {
    decltype(moving(q[0], v[0])) poses[bodies];
    for (int k = 0; k < bodies; ++k) poses[k] = moving(q[k], v[k]);
    f(poses, jets_of<typename Joint::template Parameters<Jet<T>>>(batch, slot, false), Jet<T>{time, T(1), T(0)});
  }
  [[gnu::noinline]] static void motion(const Batch<S>& batch, int slot, const Pose (&q)[bodies],
                                       const Velocity (&v)[bodies], T time, Jet<T> (&C)[rows]) {
    along_motion(batch, slot, q, v, time, [&](const auto& poses, const auto& p, const Jet<T>& now) {
      block_of<Block>(batch).position(poses, p, now, C);
    });
  }
  // J v of a slot at constant v.
  [[gnu::noinline]] static void change_of_rates(const Batch<S>& batch, int slot, const Pose (&q)[bodies],
                                                const Velocity (&v)[bodies], T time, Jet<T> (&Jv)[rows]) {
    along_motion(batch, slot, q, v, time, [&](const auto& poses, const auto& p, const Jet<T>& now) {
      typename Block::template Jacobian<Jet<T>> J;
      decltype(steady(v[0])) of[bodies];
      for (int k = 0; k < bodies; ++k) of[k] = steady(v[k]);
      Jet<T> C[rows];
      block_of<Block>(batch).jacobian(poses, p, now, C, J);
      block_of<Block>(batch).velocity(J, of, Jv);
    });
  }

  // Rows of velocities. Numbers in time have no others beside these (check_functions()).
  static constexpr bool may_lack_position = [] {
    if constexpr (is_made_by_program<Block>) return true;
    else return rows > 0 && Block::row_kinds[0] == RowKind::velocity;
  }();

  // dC/dt of the slots whose parameters follow functions of time, into the bias.
  static void drift_in_time(Batch<S>& batch, int begin, int end, const Bodies<S>& all, T time) {
    for (int slot = begin; slot < end; ++slot) {
      if (batch.drives_of(slot).empty()) continue;
      if (batch.ops->lacks_position) continue;
      Pose q[bodies];
      gather(all.pose, bodies_of(batch, slot), q);
      Jet<T> C[rows];
      motion(batch, slot, q, {}, time, C);
      for (int r = 0; r < rows; ++r) batch.bias[slot * rows + r] = C[r].first;
    }
  }

  // gamma of these slots: -d^2C/dt^2, or -d(J v)/dt, without accelerations.
  static void gamma_in_time(const Batch<S>& batch, int begin, int end, const Bodies<S>& all, T time, T* out) {
    for (int slot = begin; slot < end; ++slot) {
      if (batch.drives_of(slot).empty()) continue;
      Pose q[bodies];
      Velocity v[bodies];
      gather(all.pose, bodies_of(batch, slot), q);
      gather(all.velocity, bodies_of(batch, slot), v);
      Jet<T> of_rows[rows];
      const bool of_rates = may_lack_position && batch.ops->lacks_position;
      if constexpr (may_lack_position)
        if (of_rates) change_of_rates(batch, slot, q, v, time, of_rows);
      if (!of_rates) motion(batch, slot, q, v, time, of_rows);
      for (int r = 0; r < rows; ++r) out[slot * rows + r] = -(of_rates ? of_rows[r].first : of_rows[r].second);
    }
  }

  static void evaluate(Batch<S>& batch, int begin, int end, const Bodies<S>& all, T time) {
    batch.time = time;
    if (batch.driven()) follow(batch, begin, end, time);
    for (int slot = begin; slot < end; ++slot) {
      Pose q[bodies];
      gather(all.pose, bodies_of(batch, slot), q);
      count_parameters(batch, slot, q, time);
      const Parameters& p = parameters(batch, slot);
      T C[rows];
      block_of<Block>(batch).jacobian(q, p, time, C, entries(batch, slot));
      if (counts_some_parameters(batch)) block_of<Block>(batch).position(q, p, time, C);
      count_angle(batch, slot, C);
      for (int r = 0; r < rows; ++r) batch.C[slot * rows + r] = C[r];
      T drift[rows] = {};
      if constexpr (Block::explicit_time) block_of<Block>(batch).time_derivative(q, p, time, drift);
      for (int r = 0; r < rows; ++r) batch.bias[slot * rows + r] = drift[r];
    }
    if (batch.driven()) Inherited::drift_in_time(batch, begin, end, all, time);
  }

  static void position(Batch<S>& batch, int begin, int end, const Bodies<S>& all, T time) {
    batch.time = time;
    if (batch.driven()) follow(batch, begin, end, time);
    for (int slot = begin; slot < end; ++slot) {
      Pose q[bodies];
      gather(all.pose, bodies_of(batch, slot), q);
      count_parameters(batch, slot, q, time);
      T C[rows];
      block_of<Block>(batch).position(q, parameters(batch, slot), time, C);
      count_angle(batch, slot, C);
      for (int r = 0; r < rows; ++r) batch.C[slot * rows + r] = C[r];
    }
  }

  static void gamma(const Batch<S>& batch, int begin, int end, const Bodies<S>& all, T time, T* out) {
    for (int slot = begin; slot < end; ++slot) {
      Pose q[bodies];
      Velocity v[bodies];
      gather(all.pose, bodies_of(batch, slot), q);
      gather(all.velocity, bodies_of(batch, slot), v);
      T g[rows];
      block_of<Block>(batch).gamma(q, v, parameters(batch, slot), time, g);
      for (int r = 0; r < rows; ++r) out[slot * rows + r] = g[r];
    }
    if (batch.driven()) gamma_in_time(batch, begin, end, all, time, out);
  }

  static void effective_mass(Batch<S>& batch, int begin, int end, const Bodies<S>& all) {
    for (int slot = begin; slot < end; ++slot) {
      InverseMass m[bodies];
      gather(all.effective_mass, bodies_of(batch, slot), m);
      T K[triangle];
      block_of<Block>(batch).effective_mass(entries(batch, slot), m, K);
      for (int k = 0; k < triangle; ++k) batch.factor[slot * triangle + k] = K[k];
    }
  }

  static void factorize(Batch<S>& batch, int begin, int end, const Bodies<S>& all) {
    for (int slot = begin; slot < end; ++slot) {
      const Jacobian& J = entries(batch, slot);
      InverseMass m[bodies];
      gather(all.effective_mass, bodies_of(batch, slot), m);
      T F[triangle];
      if constexpr (kernels == Kernels::robust) {
        factor_by_rows<width>(block_of<Block>(batch), J, m, F);
      } else {
        T K[triangle];
        block_of<Block>(batch).effective_mass(J, m, K);
        if constexpr (kernels == Kernels::fast) invert(K, F);
        else block_of<Block>(batch).factor(K, F);
      }
      for (int k = 0; k < triangle; ++k) batch.factor[slot * triangle + k] = F[k];
    }
  }

  // lambda = K^-1 b with the factors from factorize().
  static void solve(const Batch<S>& batch, int slot, const T (&b)[rows], T (&lambda)[rows]) {
    T F[triangle];
    for (int k = 0; k < triangle; ++k) F[k] = batch.factor[slot * triangle + k];
    if constexpr (kernels == Kernels::fast) {
      multiply(F, b, lambda);
    } else {
      block_of<Block>(batch).solve(F, b, lambda);
    }
  }

  static void velocity(const Batch<S>& batch, int begin, int end, const Velocity* of, T* out) {
    for (int slot = begin; slot < end; ++slot) {
      Velocity v[bodies];
      for (int k = 0; k < bodies; ++k) v[k] = of[bodies_of(batch, slot)[k]];
      T Jv[rows];
      block_of<Block>(batch).velocity(entries(batch, slot), v, Jv);
      for (int r = 0; r < rows; ++r) out[slot * rows + r] = Jv[r];
    }
  }

  static void apply(const Batch<S>& batch, int begin, int end, const Bodies<S>& all, const T* impulses, Velocity* to) {
    for (int slot = begin; slot < end; ++slot) {
      T lambda[rows];
      for (int r = 0; r < rows; ++r) lambda[r] = impulses[slot * rows + r];
      push(batch, slot, all, lambda, to);
    }
  }

  // to += M^-1 J^T lambda
  static void push(const Batch<S>& batch, int slot, const Bodies<S>& all, const T (&lambda)[rows], Velocity* to) {
    const int* body = bodies_of(batch, slot);
    Velocity v[bodies];
    InverseMass m[bodies];
    gather(all.effective_mass, body, m);
    for (int k = 0; k < bodies; ++k) v[k] = to[body[k]];
    block_of<Block>(batch).apply(entries(batch, slot), m, lambda, v);
    for (int k = 0; k < bodies; ++k) to[body[k]] = v[k];
  }

  // One sweep: change(slot, J, m, Jv, lambda) finds the change of a slot's lambda. Calls would cost a tenth of it.
  template <class Change>
  [[gnu::always_inline]] static inline void sweep(const Batch<S>& batch, int begin, int end, const Bodies<S>& all,
                                                  Velocity* of, T* impulses, Change change) {
    for (int slot = begin; slot < end; ++slot) {
      const int* body = bodies_of(batch, slot);
      const Jacobian& J = entries(batch, slot);
      Velocity v[bodies];
      InverseMass m[bodies];
      gather(all.effective_mass, body, m);
      for (int k = 0; k < bodies; ++k) v[k] = of[body[k]];
      T Jv[rows], lambda[rows];
      block_of<Block>(batch).velocity(J, v, Jv);
      change(slot, J, m, Jv, lambda);
      block_of<Block>(batch).apply(J, m, lambda, v);
      for (int k = 0; k < bodies; ++k) of[body[k]] = v[k];
      for (int r = 0; r < rows; ++r) impulses[slot * rows + r] += lambda[r];
    }
  }

  // K lambda = -(J v + bias)
  static void iterate(const Batch<S>& batch, int begin, int end, const Bodies<S>& all, Velocity* of, T* impulses) {
    const auto rigid = [&](int slot, const Jacobian&, const InverseMass(&)[bodies], const T(&Jv)[rows],
                           T(&lambda)[rows]) {
      T b[rows];
      for (int r = 0; r < rows; ++r) b[r] = -(Jv[r] + batch.bias[slot * rows + r]);
      solve(batch, slot, b, lambda);
    };
    sweep(batch, begin, end, all, of, impulses, rigid);
  }

  // (K + share diag K) change = -(J v + bias + rate C + share diag(K) lambda). The softness of a row follows its own
  // K_rr: a share of all of K would leave the weakest directions of a block stiff, as the bending of a weld.
  static void soften(const Batch<S>& batch, int begin, int end, const Bodies<S>& all, Velocity* of, T* impulses,
                     SoftSweep<T> soft) {
    if (kernels == Kernels::robust && soft.share != T(0))
      return BlockLoops<S, Joint, Block>::soften(batch, begin, end, all, of, impulses, soft);
    const auto change = [&](int slot, const Jacobian& J, const InverseMass(&m)[bodies], const T(&Jv)[rows],
                            T(&lambda)[rows]) {
      T K[triangle], F[triangle], b[rows];
      for (int k = 0; k < triangle; ++k) K[k] = batch.factor[slot * triangle + k];
      for (int r = 0, i = slot * rows; r < rows; ++r, ++i) {
        const T softness = soft.share * K[r * (r + 3) / 2];
        b[r] = -(Jv[r] + batch.bias[i] + soft.rate * batch.C[i] + softness * impulses[i]);
        K[r * (r + 3) / 2] += softness;
      }
      // A sweep waits for the last slot's velocities: of two rows, K^-1 is ready before them.
      if constexpr (rows == 2 && kernels != Kernels::robust) {
        invert(K, F), multiply(F, b, lambda);
      } else {
        if constexpr (kernels == Kernels::robust) factor_by_rows<width>(block_of<Block>(batch), J, m, F);
        else block_of<Block>(batch).factor(K, F);
        block_of<Block>(batch).solve(F, b, lambda);
      }
    };
    sweep(batch, begin, end, all, of, impulses, change);
  }

  // K lambda = -C, displacement = M^-1 J^T lambda
  static void correct(Batch<S>& batch, int begin, int end, Bodies<S>& all, T time) {
    for (int slot = begin; slot < end; ++slot) {
      Inherited::position(batch, slot, slot + 1, all, time);
      T b[rows], lambda[rows];
      for (int r = 0; r < rows; ++r) b[r] = -batch.C[slot * rows + r];
      solve(batch, slot, b, lambda);
      displace(batch, slot, all, lambda);
    }
  }

  [[gnu::noinline]] static void displace(Batch<S>& batch, int slot, Bodies<S>& all, const T* impulses) {
    const int* body = bodies_of(batch, slot);
    Velocity moved[bodies] = {};
    InverseMass m[bodies];
    T lambda[rows];
    gather(all.effective_mass, body, m);
    for (int r = 0; r < rows; ++r) lambda[r] = impulses[r];
    block_of<Block>(batch).apply(entries(batch, slot), m, lambda, moved);
    for (int r = 0; r < rows; ++r) batch.correction[slot * rows + r] += lambda[r];
    for (int k = 0; k < bodies; ++k)
      if (!S::immovable(m[k])) displace_body(all, body[k], moved[k]);  // infinite impulses would move it by NaN
  }

  static void dense(const Batch<S>& batch, int slot, const Bodies<S>& all, Real* J, Real* weighted, Real* K,
                    int stride) {
    using Exact = typename S::Exact;
    typename Exact::InverseMass m[bodies];
    for (int k = 0; k < bodies; ++k)
      m[k] = exact<typename Exact::InverseMass, T>(all.effective_mass[static_cast<size_t>(bodies_of(batch, slot)[k])]);
    const auto numbers = Slots::exact_entries(batch, slot);
    Real own[triangle];
    const Block block = block_of<Block>(batch);
    block.dense(numbers, *reinterpret_cast<Real(*)[rows][width]>(J));
    block.inverse_mass_jacobian(numbers, m, *reinterpret_cast<Real(*)[rows][width]>(weighted));
    block.effective_mass(numbers, m, own);
    for (int r = 0; r < rows; ++r)
      for (int s = 0; s <= r; ++s) K[r * stride + s] = own[r * (r + 1) / 2 + s];
  }

  static void stiffness_of(const Batch<S>& batch, int slot, const Bodies<S>& all, T time, const T (&lambda)[rows],
                           T (&H)[width][width]) {
    Pose q[bodies];
    gather(all.pose, bodies_of(batch, slot), q);
    block_of<Block>(batch).stiffness(q, parameters(batch, slot), time, lambda, H);
  }

  static void stiffness(const Batch<S>& batch, int slot, const Bodies<S>& all, T time, const T* impulses, T* to) {
    T lambda[rows], H[width][width];
    for (int r = 0; r < rows; ++r) lambda[r] = impulses[r];
    stiffness_of(batch, slot, all, time, lambda, H);
    for (int r = 0; r < width; ++r) std::copy_n(H[r], width, to + r * width);
  }

  static void add_stiffness(const Batch<S>& batch, int begin, int end, const Bodies<S>& all, T time,
                            typename S::Stiffness* stiffness) {
    for (int slot = begin; slot < end; ++slot) {
      const int* body = bodies_of(batch, slot);
      T lambda[rows], H[width][width];
      for (int r = 0; r < rows; ++r) lambda[r] = batch.lambda[slot * rows + r] + batch.correction[slot * rows + r];
      stiffness_of(batch, slot, all, time, lambda, H);
      for (int k = 0; k < bodies; ++k) S::subtract(stiffness[body[k]], H, k);
    }
  }

  static constexpr auto starter() -> decltype(BlockOps<S>::start_counting) {
    if constexpr (Turns::count > 0 || Turns::counts_parameters) return start_counting;
    else return nullptr;
  }

  static constexpr BlockOps<S> ops() {
    return {bodies,
            rows,
            Slots::template numbers<Parameters>(),
            Slots::template numbers<Jacobian>(),
            Turns::count,
            Block::explicit_time,
            !is_made_by_program<Block> && Inherited::may_lack_position,
            Inherited::starter(),
            evaluate,
            Inherited::position,
            Inherited::gamma,
            effective_mass,
            factorize,
            velocity,
            apply,
            iterate,
            soften,
            correct,
            displace,
            dense,
            Inherited::add_stiffness,
            Inherited::stiffness,
            nullptr,
            nullptr,
            nullptr};
  }
};

}  // namespace cdot
