// Algebraically equal forms of C outside the generated kernels, compared with the same exact values.
#pragma once

#include <cdot/planar/distance.hpp>
#include <cdot/spatial/six_dof.hpp>

#include "tests/bench/ulp/measured.hpp"

namespace cdot::ulp {

// (u.u - l^2) / (|u| + l) for |u| - l: the difference of squares in place of the difference of lengths.
struct DistanceBySquares : planar::distance {
  static constexpr std::string_view block = "rows by (u.u - l^2)/(|u| + l)", of = "rows";
  static constexpr int operations = 27;

  template <class T>
  static void position(const planar::Pose<T> (&q)[2], const Parameters<T>& p, T, T (&C)[1]) {
    using std::sqrt;
    const planar::Pose<T>& a = q[0];
    const planar::Pose<T>& b = q[1];
    const T ra_x = a.c * p.pa_x - a.s * p.pa_y;
    const T ra_y = a.c * p.pa_y + a.s * p.pa_x;
    const T rb_x = b.c * p.pb_x - b.s * p.pb_y;
    const T rb_y = b.c * p.pb_y + b.s * p.pb_x;
    const T u_x = a.x - b.x + ra_x - rb_x;
    const T u_y = a.y - b.y + ra_y - rb_y;
    const T square = u_x * u_x + u_y * u_y;
    C[0] = (square - p.l * p.l) * inverse(sqrt(square) + p.l);
  }
};

// asin(rxz) for atan2(rxz, sqrt(ryz^2 + rzz^2)), equal for perpendicular axes. Without the bounds round-off could make
// |rxz| > 1 and C a NaN.
struct TurnByArcSine : spatial::six_dof::turn_y {
  static constexpr std::string_view block = "turn_y by asin", of = "turn_y";
  static constexpr int operations = 38;

  template <class T>
  static void position(const spatial::Pose<T> (&q)[2], const spatial::six_dof::Parameters<T>& p, T, T (&C)[1]) {
    using std::asin;
    const spatial::Pose<T>& a = q[0];
    const spatial::Pose<T>& b = q[1];
    const T fa_x_x = a.xx * p.fa_x_x + a.xy * p.fa_x_y + a.xz * p.fa_x_z;
    const T fa_x_y = a.yx * p.fa_x_x + a.yy * p.fa_x_y + a.yz * p.fa_x_z;
    const T fa_x_z = a.zx * p.fa_x_x + a.zy * p.fa_x_y + a.zz * p.fa_x_z;
    const T fb_z_x = b.xx * p.fb_z_x + b.xy * p.fb_z_y + b.xz * p.fb_z_z;
    const T fb_z_y = b.yx * p.fb_z_x + b.yy * p.fb_z_y + b.yz * p.fb_z_z;
    const T fb_z_z = b.zx * p.fb_z_x + b.zy * p.fb_z_y + b.zz * p.fb_z_z;
    const T rxz = fa_x_x * fb_z_x + fa_x_y * fb_z_y + fa_x_z * fb_z_z;
    C[0] = asin(select(rxz > T(1), T(1), select(rxz < T(-1), T(-1), rxz)));
  }
};

template <class S, class Joint, class Form>
void add_form(std::vector<MeasuredBlock<typename S::T>>& all) {
  std::size_t truth = 0;
  while (all[truth].shape.joint != Joint::name || all[truth].shape.block != Form::of ||
         all[truth].shape.dimension != S::dimension)
    ++truth;
  add_block<S, Joint, Form>(all, std::string(Form::block));
  MeasuredBlock<typename S::T>& form = all.back();
  form.functions.resize(1);  // position
  form.shape.general = truth;
  form.shape.is_coordinate = all[truth].shape.is_coordinate;
  form.operations = Form::operations;
}

template <class T>
void add_forms(std::vector<MeasuredBlock<T>>& all) {
  add_form<Plane<T>, planar::distance, DistanceBySquares>(all);
  add_form<Space<T>, spatial::six_dof, TurnByArcSine>(all);
}

}  // namespace cdot::ulp
