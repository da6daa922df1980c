#pragma once

/// \file
/// Robots with four limbs and an articulated plate as bodies and joints, as a fitter would put them together.

#include "oracles/bodies.hpp"

namespace oracles::bodies {

enum class PlateKind { hinged_bar, rack_and_pinion, parallelogram };

/// What a drawing of the robot says. Limbs 1 and 2 end on half plate 1, the others on half plate 2.
struct Drawing {
  bool prismatic = false;
  std::vector<Limb> limbs;  ///< attachments from the origin of the half plate, along the axes of the base
  PlateKind kind = PlateKind::hinged_bar;
  Real azimuth = 0;        ///< of half plate 1 from the middle of the plate, before the plate turns
  Real spacing = 0;        ///< between the hinges of the halves (H4, Par4)
  Real bar_spacing = 0;    ///< between the bars (Par4)
  Real pinion_radius = 0;  ///< (I4)
  Real ratio = 1;          ///< turns of the tool a turn of the bars
  bool tool_on_half = false;
  Real3 gravity;
};

inline Real33 about(int axis, Real angle) {
  return Eigen::AngleAxis<Real>(angle, Real3::Unit(axis)).toRotationMatrix();
}

/// The robot as bodies: the base, for each limb the arm (or carriage) and its struts, half plates 1 and 2, the bars,
/// the tool. Frames: arms have the elbow in front of them, struts x towards the plate, halves x away from the middle of
/// the plate; bar 1 x towards half 1, bar 2 towards half 2; the tool as it stands before the plate turns.
class FourLimbs {
 public:
  explicit FourLimbs(Drawing drawing) : d_(std::move(drawing)) {
    bars_ = d_.kind == PlateKind::hinged_bar ? 1 : (d_.kind == PlateKind::parallelogram ? 2 : 0);
    system_.bodies = tool() + 1;
    system_.drives = static_cast<int>(d_.limbs.size());
    system_.gravity = d_.gravity;
    const std::size_t turns = bars_ == 0 ? tool() : bar(0);
    system_.inner = turn_of(turns, bars_ == 0 ? mark(0) : Real3(Real3::UnitX()));
    for (std::size_t i = 0; i < d_.limbs.size(); ++i) add_limb(i);
    if (d_.kind == PlateKind::rack_and_pinion) {
      add_slide();
      add_pinion();
    } else {
      add_bars();
      add_tool();
    }
  }

  [[nodiscard]] const System& system() const { return system_; }
  [[nodiscard]] std::size_t arm(std::size_t limb) const { return 1 + 3 * limb; }
  [[nodiscard]] std::size_t half(std::size_t k) const { return 1 + 3 * d_.limbs.size() + k; }
  [[nodiscard]] std::size_t bar(std::size_t k) const { return half(2) + k; }
  [[nodiscard]] std::size_t tool() const { return half(2) + bars_; }

  /// Middle of the origins of the halves, and the yaw of the tool, in second order along time.
  [[nodiscard]] std::vector<Dual<Dual<Real>>> plate(const Flight& flight) const {
    std::vector<Dual<Dual<Real>>> y;
    for (int k = 0; k < 3; ++k) {
      const auto of = [&](std::size_t body) {
        return value_in(flight, travel(0, Real3::Unit(k), Real3::Zero(), body, Real3::Zero()));
      };
      y.push_back((of(half(0)) + of(half(1))) * Dual<Dual<Real>>(0.5L));
    }
    y.push_back(value_in(flight, turn_of(tool(), mark(0))));
    return y;
  }

  /// Rough places of all bodies: the plate lies level at r as if its halves had not turned or slid at all, only what
  /// turns is set to `theta`, since the tool may turn more than once around.
  [[nodiscard]] Places guess(const Numbers& q, const Real3& r, Real theta) const {
    Places at(system_.bodies, Place<Real>{Real33::Identity(), r});
    at[0].p.setZero();
    const Real reach = d_.kind == PlateKind::rack_and_pinion ? 0 : d_.spacing / 2;
    for (std::size_t k = 0; k < 2; ++k) {
      at[half(k)].R = half_axes(k);
      at[half(k)].p += half_axes(k).col(0) * reach;
    }
    for (std::size_t k = 0; k < bars_; ++k) {
      at[bar(k)].R = about(2, theta) * half_axes(k);
      if (bars_ == 2) at[bar(k)].p += half_axes(k).col(1) * (d_.bar_spacing / 2);
    }
    at[tool()].R = about(2, d_.ratio * theta);
    if (d_.tool_on_half) at[tool()].p = at[half(0)].p;
    for (std::size_t i = 0; i < d_.limbs.size(); ++i) guess_limb(i, q[i], at);
    return at;
  }

 private:
  static std::size_t half_of(std::size_t limb) { return limb < 2 ? 0 : 1; }
  [[nodiscard]] Real33 limb_frame(std::size_t i) const {
    return about(2, d_.limbs[i].azimuth) * about(0, d_.limbs[i].tilt);
  }
  [[nodiscard]] Real33 half_axes(std::size_t k) const {
    return about(2, d_.azimuth + (k == 0 ? 0 : about_half_a_turn()));
  }
  static Real about_half_a_turn() { return std::acos(-1.0L); }
  /// The direction of the tool that lies along x of half k before the plate turns.
  [[nodiscard]] Real3 mark(std::size_t k) const { return half_axes(k).col(0); }
  /// Angle of a direction of a body, seen from half plate 1.
  [[nodiscard]] Reading turn_of(std::size_t body, const Real3& of) const {
    return angle(half(0), Real3::UnitX(), Real3::UnitY(), body, of);
  }
  /// Ends of a strut, in the frames of arm and half plate.
  [[nodiscard]] Real3 elbow(std::size_t i, Real side) const {
    return d_.limbs[i].elbow + side * d_.limbs[i].spacing * Real3::UnitY();
  }
  [[nodiscard]] Real3 attachment(std::size_t i, Real side) const {
    const Real3 along_base = d_.limbs[i].attachment + side * d_.limbs[i].spacing * limb_frame(i).col(1);
    return half_axes(half_of(i)).transpose() * along_base;
  }

  void add_limb(std::size_t i) {
    Equations& to = system_.equations;
    const Limb& limb = d_.limbs[i];
    const Real33 L = limb_frame(i);
    if (d_.prismatic) {
      for (int k = 0; k < 3; ++k) square(to, 0, L.col(k), arm(i), Real3::Unit((k + 1) % 3));
      const Real3 axis = L * limb.axis, across = axis.unitOrthogonal(), third = axis.cross(across);
      for (const Real3& along : {across, third})
        to.push_back({{{1, travel(0, along, limb.drive, arm(i), Real3::Zero())}}});
      to.push_back({{{1, travel(0, axis, limb.drive, arm(i), Real3::Zero())}}, static_cast<int>(i)});
    } else {
      ball(to, 0, limb.drive, arm(i), Real3::Zero());
      square(to, 0, L.col(1), arm(i), Real3::UnitX());
      square(to, 0, L.col(1), arm(i), Real3::UnitZ());
      to.push_back({{{1, angle(0, L.col(0), -L.col(2), arm(i), Real3::UnitX())}}, static_cast<int>(i)});
    }
    for (const std::size_t strut : {1U, 2U}) {
      const Real side = strut == 1 ? 0.5L : -0.5L;
      ball(to, arm(i), elbow(i, side), arm(i) + strut, Real3::Zero());
      // The second axis of the universal joint: it keeps the strut from spinning between its two ends.
      square(to, arm(i), Real3::UnitY(), arm(i) + strut, Real3::UnitZ());
      ball(to, arm(i) + strut, limb.strut * Real3::UnitX(), half(half_of(i)), attachment(i, side));
    }
  }

  /// Hinges at the ends of the bars: one bar in the middle of the halves, or two on either side of it.
  void add_bars() {
    Equations& to = system_.equations;
    const Real3 end = d_.spacing / 2 * Real3::UnitX();
    const Real3 pin = (bars_ == 2 ? d_.bar_spacing / 2 : 0) * Real3::UnitY();
    for (std::size_t k = 0; k < bars_; ++k) {
      hinge(to, half(k), pin, bar(k), end);
      hinge(to, half(1 - k), -pin, bar(k), -end);
    }
  }

  /// A bearing, and a gear that the bar drives.
  void add_tool() {
    Equations& to = system_.equations;
    if (d_.tool_on_half) {
      ball(to, half(0), Real3::Zero(), tool(), Real3::Zero());
    } else if (bars_ == 1) {
      ball(to, bar(0), Real3::Zero(), tool(), Real3::Zero());
    } else {
      for (int k = 0; k < 3; ++k) {
        const auto of = [&](std::size_t body) { return travel(0, Real3::Unit(k), Real3::Zero(), body, Real3::Zero()); };
        to.push_back({{{2, of(tool())}, {-1, of(half(0))}, {-1, of(half(1))}}});
      }
    }
    upright(to, half(0), tool());
    to.push_back({{{1, turn_of(tool(), mark(0))}, {-d_.ratio, system_.inner}}});
  }

  /// The halves slide on each other across their x axes.
  void add_slide() {
    Equations& to = system_.equations;
    for (int k = 0; k < 3; ++k) square(to, half(0), Real3::Unit(k), half(1), Real3::Unit((k + 1) % 3));
    for (const int k : {0, 2}) {
      to.push_back({{{1, travel(half(0), Real3::Unit(k), Real3::Zero(), half(1), Real3::Zero())}}});
    }
  }

  /// Stands upright between the racks. The rack of each half touches it on the half's own side, so a turn to the left
  /// takes every half along its own y axis as seen from the pinion.
  void add_pinion() {
    Equations& to = system_.equations;
    upright(to, half(0), tool());
    for (const int k : {0, 2}) {
      to.push_back({{{1, travel(half(0), Real3::Unit(k), Real3::Zero(), tool(), Real3::Zero())}}});
    }
    for (std::size_t k = 0; k < 2; ++k) {
      to.push_back({{{1, travel(half(k), Real3::UnitY(), Real3::Zero(), tool(), Real3::Zero())},
                     {d_.pinion_radius, angle(half(k), Real3::UnitX(), Real3::UnitY(), tool(), mark(k))}}});
    }
  }

  void guess_limb(std::size_t i, Real q, Places& at) const {
    const Limb& limb = d_.limbs[i];
    const Real33 L = limb_frame(i);
    Place<Real>& on = at[arm(i)];
    on = {d_.prismatic ? L : Real33(L * about(1, q)), limb.drive};
    if (d_.prismatic) on.p += q * (L * limb.axis);
    const Place<Real>& plate = at[half(half_of(i))];
    for (const std::size_t strut : {1U, 2U}) {
      const Real side = strut == 1 ? 0.5L : -0.5L;
      Place<Real>& rod = at[arm(i) + strut];
      rod.p = on.p + on.R * elbow(i, side);
      rod.R.col(0) = (plate.p + plate.R * attachment(i, side) - rod.p).normalized();
      rod.R.col(2) = rod.R.col(0).cross(L.col(1)).normalized();
      rod.R.col(1) = rod.R.col(2).cross(rod.R.col(0));
    }
  }

  Drawing d_;
  std::size_t bars_ = 0;
  System system_;
};

}  // namespace oracles::bodies
