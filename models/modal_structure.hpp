// The structure in time: how the tool point moves under a force when its modes are known. Each mode is a damped
// oscillator along its own direction; the force is taken as a straight line within a step, and for such a force the
// update is exact, so that step size limits only how well the force is sampled, never the structure's own frequency or
// damping.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/structure.hpp"

namespace stillcut {

// How far a mode is out along its direction, and how fast: m, m/s.
struct ModalMotion {
  double displacement = 0.0, velocity = 0.0;
};

class ModalStructure final : public Structure {
 public:
  // `step` in s. Throws std::invalid_argument unless every mode has frequency > 0, stiffness > 0, 0 <= damping < 1 and
  // a direction of length > 0 (it is normalised).
  ModalStructure(std::span<const Mode> modes, double step);

  // The same modes as they are at another posture: each keeps its displacement and velocity. Throws
  // std::invalid_argument where their number differs, or as the constructor does.
  void set_modes(std::span<const Mode> modes);

  // The force's displacement is exact here.
  [[nodiscard]] Eigen::Vector3d displacement_after(const Eigen::Vector3d& begin,
                                                   const Eigen::Vector3d& end) const override;
  void advance(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) override;
  void strike(const Eigen::Vector3d& impulse) override;
  [[nodiscard]] Eigen::Vector3d displacement() const override;
  [[nodiscard]] Eigen::Vector3d velocity() const override;
  [[nodiscard]] Eigen::Vector3d acceleration() const override;

  // The modes' motion, in the order of the modes; what was read from one structure can be set in another that has as
  // many modes (std::invalid_argument otherwise).
  [[nodiscard]] std::vector<ModalMotion> motion() const;
  void set_motion(std::span<const ModalMotion> motion);

  // Kinetic plus potential energy of all modes, J.
  [[nodiscard]] double energy() const;

 private:
  struct Oscillator {
    Eigen::Vector3d direction;
    double frequency, damping_ratio, mass;      // rad/s, -, kg (modal, at the tool point)
    double free_qq, free_qv, free_vq, free_vv;  // (q, v) after a step without force
    double q = 0.0, v = 0.0, drive = 0.0;       // m, m/s, force along the direction over modal mass
  };
  struct Motion {
    double q, v;
  };
  [[nodiscard]] Motion after_step(const Oscillator& mode, double drive_begin, double drive_end) const;

  double step_;
  std::vector<Oscillator> modes_;
};

}  // namespace stillcut
